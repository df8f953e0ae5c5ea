#include "study/drift_meter.h"

#include <algorithm>
#include <cmath>

#include "collision/separation.h"
#include "dynamics/constraint_rows.h"

namespace cradle {

void DriftMeter::add(const Frame& frame) {
  const EnergyBalance& energy = frame.energy;
  const double constant = energy.kinetic + energy.potential + energy.dissipated - energy.work;
  if (isFirst_) startConstant_ = constant;
  isFirst_ = false;
  energyChange_ = std::max(energyChange_, std::abs(constant - startConstant_));
  largestKinetic_ = std::max(largestKinetic_, energy.kinetic);

  const VectorX state = stateOf(frame);
  std::vector<BodyFrame> bodies;
  std::vector<ConstraintRow> rows;
  placeBodies(assembly_.mechanism.bodies, state, bodies);
  findRows(assembly_.mechanism.constraints, state, bodies, rows);
  for (const ConstraintRow& row : rows) constraintDrift_ = std::max(constraintDrift_, std::abs(row.value / row.scale));

  std::vector<Contact> overlaps;
  broadPhase_.update(state, std::vector<double>(frame.states.size(), 0.0), 0, geometry_);
  findContacts(geometry_, state, 0, overlaps);
  for (const Contact& overlap : overlaps) penetration_ = std::max(penetration_, -overlap.separation);
}

double DriftMeter::energyDrift() const {
  return largestKinetic_ > 0 ? energyChange_ / largestKinetic_ : 0;
}

VectorX DriftMeter::stateOf(const Frame& frame) const {
  VectorX state = assembly_.state;
  for (std::size_t i = 0; i < frame.states.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    centerOfMass(state, body) = frame.states[i].position;
    setOrientation(state, body, frame.states[i].orientation);
  }
  return state;
}

}  // namespace cradle
