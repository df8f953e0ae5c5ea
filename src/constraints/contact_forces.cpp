// Friction of sliding is a part of its normal force, so the response to a multiplier is not the transpose of its row: J
// M^-1 (J^T + F) lambda = b, F the friction that goes with each normal force (D. Baraff, "Coping with friction for
// non-penetrating rigid body simulation", SIGGRAPH 1991). Constraints are eliminated first: contacts see the motion
// that they leave, and with the multipliers of contacts known, the constraints take their part of it.
//
// Projection is Newton's method on gaps and constraints, group by group. Directions in which rows depend on each other
// are left alone.

#include "constraints/contact_forces.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr int kMaxProjectionSteps = 20;  // quadratic convergence needs 1 or 2 from a step's error
constexpr double kStalled = 0.5;         // a step that leaves more of an error has met rounding, or contradictions

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

ContactSolver::ContactSolver(const std::vector<ContactConstraint>& contacts, const Constraints& constraints,
                             const std::vector<RigidBody>& bodies)
    : contacts_(contacts), constraints_(constraints), bodies_(bodies), constraintSolver_(constraints, bodies) {}

void ContactSolver::factorize(const VectorX& state, const std::vector<BodyFrame>& frames,
                              const std::vector<char>& resting) {
  fillRows(state, frames, resting);
  for (Group& group : groups_) {
    couple(group);
    group.solver.factorize(group.rows, group.slides);
  }
  if (hasFreeConstraints_) constraintSolver_.factorize(state, frames);
}

ContactSolver::Joint ContactSolver::jointOf(const ContactConstraint& contact) {
  return {contact.centerA.body, contact.surfaceB.body, static_cast<int>(contact.motion)};
}

ContactSolver::Joint ContactSolver::jointOf(const Constraint& constraint) {
  return {constraint.anchorA.body, constraint.anchorB.body, rowCount(constraint)};
}

bool ContactSolver::hasKnownStructure(const std::vector<char>& resting) const {
  const auto isKnown = [](const auto& joint, const Joint& known) { return jointOf(joint) == known; };
  return resting == resting_ &&
         std::equal(contacts_.begin(), contacts_.end(), contactJoints_.begin(), contactJoints_.end(), isKnown) &&
         std::equal(constraints_.begin(), constraints_.end(), constraintJoints_.begin(), constraintJoints_.end(),
                    isKnown);
}

/// kFixed for bodies at rest.
int ContactSolver::movingBody(int body) const {
  return body == kFixed || resting_[index(body)] ? kFixed : body;
}

void ContactSolver::analyze(const std::vector<char>& resting) {
  resting_ = resting;
  contactJoints_.clear(), constraintJoints_.clear();
  for (const ContactConstraint& contact : contacts_) contactJoints_.push_back(jointOf(contact));
  for (const Constraint& constraint : constraints_) constraintJoints_.push_back(jointOf(constraint));
  groups_.clear();
  std::vector<char> isGrouped(bodies_.size(), 0), isDriven;
  std::vector<char> joinsNothing = resting;  // no force on them changes what they do to others
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    isDriven.push_back(bodies_[i].isDriven());
    if (isDriven[i]) joinsNothing[i] = 1;
  }
  for (ContactGroup& members : findContactGroups(contacts_, constraints_, joinsNothing)) {
    std::vector<char> isOther(bodies_.size(), 1);
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      if (isDriven[i]) isOther[i] = 0;
    for (const int body : members.bodies) isGrouped[index(body)] = 1, isOther[index(body)] = 0;
    Group& group = groups_.emplace_back(Group{std::move(members)});
    if (group.members.hasConstraints) group.constraints.emplace(constraints_, bodies_).exclude(isOther, resting);
  }
  constraintSolver_.exclude(isGrouped, resting);
  hasFreeConstraints_ = std::any_of(constraints_.begin(), constraints_.end(), [this](const Constraint& constraint) {
    return !constraintSolver_.isExcluded(constraint);
  });
  sizeRows();
}

void ContactSolver::sizeRows() {
  int rows = 0;
  for (Group& group : groups_) {
    group.firstRow = rows;
    group.rows = group.positionRows();
    for (const int contact : group.members.contacts) {
      const ContactMotion motion = contacts_[index(contact)].motion;
      if (motion == ContactMotion::sticking) group.rows += 2;
      if (motion == ContactMotion::sliding) group.slides = true;
    }
    rows += group.rows;
    group.solver.resize(group.rows);
  }
  const std::size_t size = index(rows);
  rows_.resize(size);
  responses_.resize(size), coupled_.resize(size);
  constrained_.resize(size), constrainedCoupled_.resize(size);
  multipliers_.resize(size);
  kinematics_.resize(contacts_.size());
  forces_.assign(contacts_.size(), {});
  bilateralMultipliers_.setZero(rowCount(constraints_));
}

void ContactSolver::fillRows(const VectorX& state, const std::vector<BodyFrame>& frames,
                             const std::vector<char>& resting) {
  if (!hasKnownStructure(resting)) analyze(resting);
  for (Group& group : groups_) {
    int row = group.firstRow, tangentRow = group.firstRow + group.positionRows();
    for (const int contact : group.members.contacts) fillContact(index(contact), row++, tangentRow, state, frames);
    if (!group.constraints) continue;
    group.constraints->factorize(state, frames);
    constrainResponses(group, state.size());
  }
}

void ContactSolver::fillContact(std::size_t contact, int row, int& tangentRow, const VectorX& state,
                                const std::vector<BodyFrame>& frames) {
  const ContactConstraint& constraint = contacts_[contact];
  const ContactKinematics& place = kinematics_[contact] = kinematicsOf(constraint, state, frames);
  forces_[contact] = {0, Vec3::Zero(), place.normal, place.point, tangentialVelocity(place), Vec3::Zero()};
  putRow(row, normalRow(constraint, place), frames);
  if (constraint.motion == ContactMotion::sliding) {
    forces_[contact].slidingDirection = slidingDirection(constraint, place, frames);
    addFriction(contact, row, frames);
  }
  if (constraint.motion != ContactMotion::sticking) return;
  for (const ConstraintRow& tangent : tangentRows(constraint, place)) putRow(tangentRow++, tangent, frames);
}

/// Bodies at rest are fixed to a row.
void ContactSolver::putRow(int row, const ConstraintRow& from, const std::vector<BodyFrame>& frames) {
  ConstraintRow& to = rows_[index(row)] = from;
  to.bodyA = movingBody(from.bodyA);
  to.bodyB = movingBody(from.bodyB);
  coupled_[index(row)] = responses_[index(row)] = responseTo(to, bodies_, frames);
}

/// Adds to the response to a normal force that to the friction that goes with it.
void ContactSolver::addFriction(std::size_t contact, int row, const std::vector<BodyFrame>& frames) {
  const ContactKinematics& place = kinematics_[contact];
  const Vec3 force = -contacts_[contact].friction * forces_[contact].slidingDirection;
  ConstraintRow friction;
  friction.bodyA = rows_[index(row)].bodyA;
  friction.bodyB = rows_[index(row)].bodyB;
  friction.linearA = force;
  friction.angularA = place.armA.cross(force);
  friction.linearB = -force;
  friction.angularB = -place.armB.cross(force);
  const RowResponse response = responseTo(friction, bodies_, frames);
  RowResponse& sum = coupled_[index(row)];
  sum.linearA += response.linearA;
  sum.angularA += response.angularA;
  sum.linearB += response.linearB;
  sum.angularB += response.angularB;
}

/// Whether one of a group's rows, counted from its first, is the gap of a sliding contact.
bool ContactSolver::isSliding(const Group& group, int row) const {
  return row < group.positionRows() &&
         contacts_[index(group.members.contacts[index(row)])].motion == ContactMotion::sliding;
}

void ContactSolver::constrainResponses(Group& group, Eigen::Index stateSize) {
  const auto constrain = [&](int row, const RowResponse& alone, VectorX& response) {
    response.setZero(stateSize);
    addResponse(rows_[index(row)], alone, 1, response);
    group.constraints->constrainVelocities(response);
  };
  for (int i = 0; i < group.rows; ++i) {
    const std::size_t row = index(group.firstRow + i);
    constrain(group.firstRow + i, responses_[row], constrained_[row]);
    if (isSliding(group, i)) constrain(group.firstRow + i, coupled_[row], constrainedCoupled_[row]);
  }
}

double ContactSolver::entryOf(const Group& group, int row, int column) const {
  return group.constraints ? rateOf(rows_[index(row)], constrained_[index(column)])
                           : delassusEntry(rows_[index(row)], rows_[index(column)], responses_[index(column)]);
}

double ContactSolver::coupledEntryOf(const Group& group, int row, int column) const {
  return group.constraints ? rateOf(rows_[index(row)], constrainedCoupled_[index(column)])
                           : delassusEntry(rows_[index(row)], rows_[index(column)], coupled_[index(column)]);
}

/// The matrices of a group. Columns differ with friction alone.
void ContactSolver::couple(Group& group) {
  const int first = group.firstRow;
  for (int column = 0; column < group.rows; ++column) {
    for (int row = column; row < group.rows; ++row) {
      const double entry = entryOf(group, first + row, first + column);
      group.solver.symmetric(row, column) = entry;
      group.solver.symmetric(column, row) = entry;
    }
    const std::size_t own = index(first + column);
    group.solver.whole(column) = group.constraints ? delassusEntry(rows_[own], rows_[own], responses_[own])
                                                   : group.solver.symmetric(column, column);
  }
  if (!group.slides) return;
  for (int column = 0; column < group.rows; ++column)
    for (int row = 0; row < group.rows; ++row)
      group.solver.coupled(row, column) = isSliding(group, column) ? coupledEntryOf(group, first + row, first + column)
                                                                   : group.solver.symmetric(row, column);
}

/// Adds to a motion (accelerations, velocities, or displacements in their place) what the leading rows of a group and
/// its constraints ask for: constrain(solver, motion) does what the constraints alone ask, and residual(row, motion) is
/// what a row leaves of what it asks.
template <class Constrain, class Residual>
void ContactSolver::solve(Group& group, int rows, const std::vector<RowResponse>& responses, const Constrain& constrain,
                          const Residual& residual, VectorX& motion) {
  if (group.constraints) {
    free_ = motion;
    constrain(*group.constraints, free_);
  }
  const VectorX& free = group.constraints ? free_ : motion;
  for (int row = group.firstRow; row < group.firstRow + rows; ++row)
    multipliers_[index(row)] = -residual(rows_[index(row)], free);
  group.solver.solve(&multipliers_[index(group.firstRow)]);
  for (int row = group.firstRow; row < group.firstRow + rows; ++row)
    addResponse(rows_[index(row)], responses[index(row)], multipliers_[index(row)], motion);
  if (group.constraints) constrain(*group.constraints, motion);
}

void ContactSolver::constrainAccelerations(VectorX& derivative) {
  for (Group& group : groups_) {
    solve(
        group, group.rows, coupled_,
        [](ConstraintSolver& constraints, VectorX& motion) { constraints.constrainAccelerations(motion); },
        [](const ConstraintRow& row, const VectorX& motion) { return row.velocityProduct + rateOf(row, motion); },
        derivative);
    takeForces(group, derivative);
  }
  if (!hasFreeConstraints_) return;
  constraintSolver_.constrainAccelerations(derivative);
  constraintSolver_.putMultipliers(bilateralMultipliers_);
}

/// Notes the forces that go with a group's multipliers, and what friction takes.
void ContactSolver::takeForces(const Group& group, VectorX& derivative) {
  int row = group.firstRow, tangentRow = group.firstRow + group.positionRows();
  for (const int i : group.members.contacts) {
    const ContactConstraint& contact = contacts_[index(i)];
    ContactForce& force = forces_[index(i)];
    force.normal = multipliers_[index(row++)];
    if (contact.motion == ContactMotion::sliding) {
      force.tangential = -contact.friction * force.normal * force.slidingDirection;
      frictionEnergy(derivative) -= force.tangential.dot(force.tangentialVelocity);
    }
    if (contact.motion != ContactMotion::sticking) continue;
    for (int k = 0; k < 2; ++k, ++tangentRow)
      force.tangential += multipliers_[index(tangentRow)] * rows_[index(tangentRow)].linearA;
  }
  if (group.constraints) group.constraints->putMultipliers(bilateralMultipliers_);
}

void ContactSolver::constrainVelocities(VectorX& state) {
  for (Group& group : groups_)
    if (group.slides) group.solver.factorize(group.rows, false);
  constrainGroupVelocities(state);
  if (hasFreeConstraints_) constraintSolver_.constrainVelocities(state);
}

/// Needs the matrices factorised without friction.
void ContactSolver::constrainGroupVelocities(VectorX& state) {
  for (Group& group : groups_)
    solve(
        group, group.rows, responses_,
        [](ConstraintSolver& constraints, VectorX& motion) { constraints.constrainVelocities(motion); },
        [](const ConstraintRow& row, const VectorX& motion) { return rateOf(row, motion); }, state);
}

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
  fillRows(state, frames_, resting);
}

double ContactSolver::errorOf(const Group& group) const {
  double error = group.constraints ? group.constraints->largestError() : 0;
  for (int i = group.firstRow; i < group.firstRow + group.positionRows(); ++i)
    error = std::max(error, std::abs(rows_[index(i)].value));
  return error;
}

bool ContactSolver::isRounding(const Group& group) const {
  const auto first = rows_.begin() + group.firstRow;
  return (!group.constraints || group.constraints->holdToRounding()) &&
         std::all_of(first, first + group.positionRows(),
                     [](const ConstraintRow& row) { return std::abs(row.value) <= row.rounding; });
}

/// One step of Newton's method.
void ContactSolver::displace(Group& group, VectorX& state) {
  couple(group);
  group.solver.factorize(group.positionRows(), false);
  displacement_.setZero(state.size());
  solve(
      group, group.positionRows(), responses_,
      [](ConstraintSolver& constraints, VectorX& motion) { constraints.constrainDisplacements(motion); },
      [](const ConstraintRow& row, const VectorX& motion) { return row.value + rateOf(row, motion); }, displacement_);
  for (const int body : group.members.bodies) {
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
    for (const int body : group.members.bodies)
      state.segment<kPoseSize>(body * kPoseSize) = undisplaced_.segment<kPoseSize>(body * kPoseSize);
  return isWorse;
}

}  // namespace cradle
