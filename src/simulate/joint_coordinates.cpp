#include "simulate/joint_coordinates.h"

namespace cradle {

JointCoordinates::JointCoordinates(const Assembly& assembly) : assembly_(assembly), last_(assembly.joints.size()) {
  for (std::size_t i = 0; i < last_.size(); ++i) last_[i] = assembly.joints[i].start;
  beginStep(assembly.state);
}

JointState JointCoordinates::stateOf(std::size_t joint, double length, const VectorX& state) const {
  const Constraint& constraint = assembly_.joints[joint].coordinate;
  const auto& kind = std::get<JointCoordinate>(constraint.kind);
  ConstraintBlock block;
  findRows(constraint, state, frames_, block);
  const double velocity = rateOf(block, 0, state);
  const JointState& last = last_[joint];
  const double expected = last.coordinate + length * (last.velocity + velocity) / 2;
  return {kind.turns ? nearestTurn(block.value[0], expected) : block.value[0], velocity};
}

void JointCoordinates::beginStep(const VectorX& state) {
  find(0, state, last_);
}

void JointCoordinates::endStep(double length, const VectorX& state) {
  find(length, state, last_);
}

void JointCoordinates::find(double length, const VectorX& state, std::vector<JointState>& found) {
  if (last_.empty()) return;
  findBodyFrames(assembly_.mechanism.bodies, state, frames_);
  for (std::size_t i = 0; i < last_.size(); ++i) found[i] = stateOf(i, length, state);
}

}  // namespace cradle
