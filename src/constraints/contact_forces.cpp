// Rows of contacts and constraints solved together. Friction of sliding is a part of its normal force, so the response
// to a multiplier is not the transpose of its row: J M^-1 (J^T + F) lambda = b, F the friction that goes with each
// normal force (D. Baraff, "Coping with friction for non-penetrating rigid body simulation", SIGGRAPH 1991).

#include "constraints/contact_forces.h"

namespace cradle {
namespace {

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

ContactSolver::ContactSolver(const std::vector<ContactConstraint>& contacts, const Constraints& constraints,
                             const std::vector<RigidBody>& bodies)
    : contacts_(contacts), constraints_(constraints), bodies_(bodies), constraintSolver_(constraints, bodies) {}

void ContactSolver::factorize(const VectorX& state, const std::vector<BodyFrame>& frames,
                              const std::vector<char>& resting) {
  findBilateralRows(state, frames);
  if (!hasKnownStructure(resting)) analyze(resting);
  fillRows(state, frames);
  for (Group& group : groups_) {
    couple(group);
    group.solver.factorize(group.rows, group.slides);
  }
  if (hasFreeConstraints_) constraintSolver_.factorize(state, frames);
}

void ContactSolver::findBilateralRows(const VectorX& state, const std::vector<BodyFrame>& frames) {
  if (constraints_.empty())
    bilateralRows_.clear();
  else
    findRows(constraints_, state, frames, bilateralRows_);
}

void ContactSolver::fillRows(const VectorX& state, const std::vector<BodyFrame>& frames) {
  for (const Group& group : groups_) {
    int row = group.firstRow, tangentRow = group.firstRow + group.positionRows;
    for (const int contact : group.contacts) fillContact(index(contact), row++, tangentRow, state, frames);
    for (const int bilateral : group.bilateral) {
      putRow(row, bilateralRows_[index(bilateral)], frames);
      coupled_[index(row)] = responses_[index(row)];
      ++row;
    }
  }
}

void ContactSolver::fillContact(std::size_t contact, int row, int& tangentRow, const VectorX& state,
                                const std::vector<BodyFrame>& frames) {
  const ContactConstraint& constraint = contacts_[contact];
  const ContactKinematics& place = kinematics_[contact] = kinematicsOf(constraint, state, frames);
  forces_[contact] = {0, Vec3::Zero(), place.normal, place.point, tangentialVelocity(place), Vec3::Zero()};
  putRow(row, normalRow(constraint, place), frames);
  coupled_[index(row)] = responses_[index(row)];
  if (constraint.motion == ContactMotion::sliding) {
    forces_[contact].slidingDirection = slidingDirection(constraint, place, frames);
    addFriction(contact, row, frames);
  }
  if (constraint.motion != ContactMotion::sticking) return;
  for (const ConstraintRow& tangent : tangentRows(constraint, place)) {
    putRow(tangentRow, tangent, frames);
    coupled_[index(tangentRow)] = responses_[index(tangentRow)];
    ++tangentRow;
  }
}

/// A row in units in which its multiplier is a force or a torque; bodies at rest are fixed to it.
void ContactSolver::putRow(int row, const ConstraintRow& from, const std::vector<BodyFrame>& frames) {
  ConstraintRow& to = rows_[index(row)] = from;
  to.bodyA = movingBody(from.bodyA);
  to.bodyB = movingBody(from.bodyB);
  if (from.scale != 1) {
    const double factor = 1 / from.scale;
    for (Vec3* part : {&to.linearA, &to.angularA, &to.linearB, &to.angularB}) *part *= factor;
    to.value *= factor;
    to.velocityProduct *= factor;
    to.scale = 1;
  }
  responses_[index(row)] = responseTo(rows_[index(row)], bodies_, frames);
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

/// The matrices of a group. Columns differ with friction alone.
void ContactSolver::couple(Group& group) {
  const int first = group.firstRow;
  for (int column = 0; column < group.rows; ++column) {
    const std::size_t from = index(first + column);
    for (int row = column; row < group.rows; ++row) {
      const double entry = delassusEntry(rows_[index(first + row)], rows_[from], responses_[from]);
      group.solver.symmetric(row, column) = entry;
      group.solver.symmetric(column, row) = entry;
    }
  }
  if (!group.slides) return;
  for (int column = 0; column < group.rows; ++column) {
    const std::size_t from = index(first + column);
    const bool isSliding = column < static_cast<int>(group.contacts.size()) &&
                           contacts_[index(group.contacts[index(column)])].motion == ContactMotion::sliding;
    for (int row = 0; row < group.rows; ++row)
      group.solver.coupled(row, column) = isSliding
                                              ? delassusEntry(rows_[index(first + row)], rows_[from], coupled_[from])
                                              : group.solver.symmetric(row, column);
  }
}

/// Adds to velocities, or their rates, what the multipliers of a group's leading rows do.
void ContactSolver::addResponse(const Group& group, int rows, const std::vector<RowResponse>& responses,
                                VectorX& derivative) const {
  for (int i = group.firstRow; i < group.firstRow + rows; ++i)
    cradle::addResponse(rows_[index(i)], responses[index(i)], multipliers_[index(i)], derivative);
}

void ContactSolver::constrainAccelerations(VectorX& derivative) {
  for (Group& group : groups_) {
    for (int row = group.firstRow; row < group.firstRow + group.rows; ++row)
      multipliers_[index(row)] = -(rows_[index(row)].velocityProduct + rateOf(rows_[index(row)], derivative));
    group.solver.solve(&multipliers_[index(group.firstRow)]);
    addResponse(group, group.rows, coupled_, derivative);
    takeForces(group, derivative);
  }
  if (!hasFreeConstraints_) return;
  const VectorX& multipliers = constraintSolver_.constrainAccelerations(derivative);
  Eigen::Index next = 0;
  for (std::size_t row = 0; row < bilateralRows_.size(); ++row)
    if (!constraintSolver_.isExcluded(bilateralRows_[row].bodyA, bilateralRows_[row].bodyB))
      bilateralMultipliers_[static_cast<Eigen::Index>(row)] = multipliers[next++];
}

/// Notes the forces that go with a group's multipliers, and what friction takes.
void ContactSolver::takeForces(const Group& group, VectorX& derivative) {
  int row = group.firstRow, tangentRow = group.firstRow + group.positionRows;
  for (const int i : group.contacts) {
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
  for (const int bilateral : group.bilateral)
    bilateralMultipliers_[bilateral] = multipliers_[index(row++)] / bilateralRows_[index(bilateral)].scale;
}

void ContactSolver::constrainVelocities(VectorX& state) {
  for (Group& group : groups_)
    if (group.slides) group.solver.factorize(group.rows, false);
  constrainGroupVelocities(state);
  if (hasFreeConstraints_) constraintSolver_.constrainVelocities(state);
}

/// Needs the matrices factorised without friction.
void ContactSolver::constrainGroupVelocities(VectorX& state) {
  for (Group& group : groups_) {
    for (int row = group.firstRow; row < group.firstRow + group.rows; ++row)
      multipliers_[index(row)] = -rateOf(rows_[index(row)], state);
    group.solver.solve(&multipliers_[index(group.firstRow)]);
    addResponse(group, group.rows, responses_, state);
  }
}

}  // namespace cradle
