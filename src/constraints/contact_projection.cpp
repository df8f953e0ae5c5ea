// Newton's method on gaps and constraints, group by group. Directions in which rows depend on each other are left
// alone.

#include <algorithm>
#include <cmath>

#include "constraints/contact_forces.h"

namespace cradle {
namespace {

constexpr int kMaxProjectionSteps = 20;  // quadratic convergence needs 1 or 2 from a step's error
constexpr double kStalled = 0.5;         // a step that leaves more of an error has met rounding, or contradictions

}  // namespace

double ContactSolver::project(VectorX& state, const std::vector<char>& resting) {
  placeRows(state, resting);
  double found = 0;
  for (Group& group : groups_) {
    group.error = errorOf(group);
    group.isPlaced = isRounding(group);
    found = std::max(found, group.error);
  }
  const auto isPlaced = [](const Group& group) { return group.isPlaced; };
  for (int i = 0; i < kMaxProjectionSteps && !std::all_of(groups_.begin(), groups_.end(), isPlaced); ++i) {
    undisplaced_ = state;
    for (Group& group : groups_)
      if (!group.isPlaced) displace(group, state);
    placeRows(state, resting);
    bool isUndone = false;
    for (Group& group : groups_)
      if (!group.isPlaced) isUndone = judge(group, state) || isUndone;
    if (isUndone) placeRows(state, resting);
  }
  for (Group& group : groups_) {
    couple(group);
    group.solver.factorize(group.rows, false);
  }
  if (hasFreeConstraints_) found = std::max(found, constraintSolver_.project(state));
  constrainGroupVelocities(state);
  return found;
}

void ContactSolver::placeRows(const VectorX& state, const std::vector<char>& resting) {
  findBodyFrames(bodies_, state, frames_);
  findBilateralRows(state, frames_);
  if (!hasKnownStructure(resting)) analyze(resting);
  fillRows(state, frames_);
}

double ContactSolver::errorOf(const Group& group) const {
  double error = 0;
  for (int i = group.firstRow; i < group.firstRow + group.positionRows; ++i)
    error = std::max(error, std::abs(rows_[static_cast<std::size_t>(i)].value));
  return error;
}

bool ContactSolver::isRounding(const Group& group) const {
  const auto first = rows_.begin() + group.firstRow;
  return std::all_of(first, first + group.positionRows,
                     [](const ConstraintRow& row) { return std::abs(row.value) <= row.rounding; });
}

/// One step of Newton's method.
void ContactSolver::displace(Group& group, VectorX& state) {
  couple(group);
  group.solver.factorize(group.positionRows, false);
  for (int row = group.firstRow; row < group.firstRow + group.positionRows; ++row)
    multipliers_[static_cast<std::size_t>(row)] = -rows_[static_cast<std::size_t>(row)].value;
  group.solver.solve(&multipliers_[static_cast<std::size_t>(group.firstRow)]);
  displacement_.setZero(state.size());
  addResponse(group, group.positionRows, responses_, displacement_);
  for (const int body : group.bodies) {
    centerOfMass(state, body) += linearVelocity(displacement_, body);
    turnBody(state, body, angularVelocity(displacement_, body));
  }
}

/// Whether the last step of a group made it worse, and was undone.
bool ContactSolver::judge(Group& group, VectorX& state) const {
  const double left = errorOf(group), before = group.error;
  const bool isWorse = !(left < before);
  group.isPlaced = isRounding(group) || !(left < kStalled * before);
  if (!isWorse) group.error = left;
  if (isWorse)
    for (const int body : group.bodies)
      state.segment<kPoseSize>(body * kPoseSize) = undisplaced_.segment<kPoseSize>(body * kPoseSize);
  return isWorse;
}

}  // namespace cradle
