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
#include <utility>

namespace cradle {
namespace {

constexpr int kMaxProjectionSteps = 20;  // quadratic convergence needs 1 or 2 from a step's error
constexpr double kStalled = 0.5;         // a step that leaves more of an error has met rounding, or contradictions

std::size_t index(int i) {
  return static_cast<std::size_t>(i);
}

template <class Visit>
[[gnu::always_inline]] inline void withContactRows(int rows, const Visit& visit) {
  rows == 1 ? visit(std::integral_constant<int, 1>()) : visit(std::integral_constant<int, 3>());
}

}  // namespace

ContactSolver::ContactSolver(const std::vector<ContactConstraint>& contacts, const Constraints& constraints,
                             const std::vector<RigidBody>& bodies)
    : contacts_(contacts), constraints_(constraints), bodies_(bodies), constraintSolver_(constraints, bodies) {}

void ContactSolver::factorize(double time, const VectorX& state, const std::vector<BodyFrame>& frames,
                              const std::vector<char>& resting) {
  place(state, frames, resting);
  findBlocks(frames, true);
  for (Group& group : groups_) {
    couple(group);
    if (group.slides) coupleFriction(group, frames, time);
    group.solver.factorize(group.rows, group.slides, group.slides && sharesLoads(group));
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
    std::vector<std::pair<int, int>> joined;
    for (const int contact : group.members.contacts)
      joined.emplace_back(contactJoints_[index(contact)].bodyA, contactJoints_[index(contact)].bodyB);
    group.hasNoLoop = joinWithoutLoop(joined, joinsNothing, group.members.hasConstraints);
    if (group.members.hasConstraints) group.constraints.emplace(constraints_, bodies_).exclude(isOther, resting);
  }
  constraintSolver_.exclude(isGrouped, resting);
  hasFreeConstraints_ = std::any_of(constraints_.begin(), constraints_.end(), [this](const Constraint& constraint) {
    return !constraintSolver_.isExcluded(constraint);
  });
  sizeRows();
}

void ContactSolver::sizeRows() {
  std::size_t most = 0;
  for (Group& group : groups_) {
    int rows = 0;
    for (const int contact : group.members.contacts) {
      const ContactMotion motion = contacts_[index(contact)].motion;
      rows += motion == ContactMotion::sticking ? 3 : 1;
      if (motion == ContactMotion::sliding) group.slides = true;
    }
    group.solver.resize(rows);
    most = std::max(most, index(rows));
  }
  multipliers_.resize(most);
  blocks_.resize(contacts_.size());
  kinematics_.resize(contacts_.size());
  forces_.assign(contacts_.size(), {});
  bilateralMultipliers_.setZero(rowCount(constraints_));
}

/// Finds where the contacts are, and factorises the constraints there.
void ContactSolver::place(const VectorX& state, const std::vector<BodyFrame>& frames,
                          const std::vector<char>& resting) {
  if (!hasKnownStructure(resting)) analyze(resting);
  for (Group& group : groups_) {
    for (const int contact : group.members.contacts) {
      const std::size_t i = index(contact);
      const ContactKinematics& place = kinematics_[i] = kinematicsOf(contacts_[i], state, frames);
      forces_[i] = {0, Vec3::Zero(), place.normal, place.point, tangentialVelocity(place), Vec3::Zero()};
    }
    if (group.constraints) group.constraints->factorize(state, frames);
  }
}

/// The rows of the contacts, with or without those along the surfaces where they stick.
void ContactSolver::findBlocks(const std::vector<BodyFrame>& frames, bool withTangents) {
  for (Group& group : groups_) {
    group.rows = 0;
    for (const int contact : group.members.contacts) {
      const std::size_t i = index(contact);
      ConstraintBlock& block = blocks_[i].rows.block;
      findRows(contacts_[i], kinematics_[i], withTangents && contacts_[i].motion == ContactMotion::sticking, block);
      if (movingBody(block.bodyA) == kFixed) block.bodyA = kFixed, block.turnsA = false;
      if (movingBody(block.bodyB) == kFixed) block.bodyB = kFixed, block.turnsB = false;
      findResponse(group, frames, blocks_[i].rows);
      blocks_[i].firstRow = group.rows;
      group.rows += block.rows;
    }
  }
}

void ContactSolver::findResponse(Group& group, const std::vector<BodyFrame>& frames, Response& response) {
  cradle::findResponse(response.block, bodies_, frames, response.alone);
  if (!group.constraints) return;
  for (int k = 0; k < response.block.rows; ++k) {
    std::array<double, 3> multipliers{};
    multipliers[index(k)] = 1;
    VectorX& velocities = response.constrained[index(k)];
    velocities.setZero(stateSize(std::ssize(bodies_)));
    addResponse(response.block, response.alone, multipliers.data(), velocities);
    group.constraints->constrainVelocities(velocities);
  }
}

/// Entries of a group's matrix: what the rows of a contact see of 1 of each multiplier of `of`.
template <int rows, int columns>
[[gnu::always_inline]] inline Eigen::Matrix<double, rows, columns> ContactSolver::entriesOf(const Group& group,
                                                                                            const ConstraintBlock& seen,
                                                                                            const Response& of) {
  Eigen::Matrix<double, rows, columns> entries;
  const SharedBodies shared = sharedBodies(seen, of.block);
  if (group.constraints)
    for (int k = 0; k < columns; ++k) findRates<rows>(seen, of.constrained[index(k)], &entries(0, k));
  else if (shared.any())
    putDelassus<rows, columns>(seen, of.block, shared, of.alone, entries.data(), rows);
  else
    entries.setZero();
  return entries;
}

/// The matrix of a group without friction.
void ContactSolver::couple(Group& group) {
  const std::vector<int>& contacts = group.members.contacts;
  for (std::size_t k = 0; k < contacts.size(); ++k)
    for (std::size_t i = k; i < contacts.size(); ++i) {
      const ActiveBlock &row = blocks_[index(contacts[i])], &column = blocks_[index(contacts[k])];
      withContactRows(row.rows.block.rows, [&](auto rows) {
        withContactRows(column.rows.block.rows, [&](auto columns) {
          const auto entries = entriesOf<rows, columns>(group, row.rows.block, column.rows);
          for (int x = 0; x < columns; ++x)
            for (int y = 0; y < rows; ++y) {
              group.solver.symmetric(row.firstRow + y, column.firstRow + x) = entries(y, x);
              group.solver.symmetric(column.firstRow + x, row.firstRow + y) = entries(y, x);
            }
        });
      });
    }
  findDiagonal(group);
}

/// The diagonal of a group's matrix as it were without constraints.
void ContactSolver::findDiagonal(Group& group) {
  for (const int contact : group.members.contacts) {
    const Response& of = blocks_[index(contact)].rows;
    const int first = blocks_[index(contact)].firstRow;
    withContactRows(of.block.rows, [&](auto rows) {
      std::array<double, static_cast<std::size_t>(rows * rows)> entries{};
      if (group.constraints) putDelassus<rows>(of.block, of.alone, entries.data());
      for (int k = 0; k < rows; ++k)
        group.solver.whole(first + k) =
            group.constraints ? entries[index(k * (rows + 1))] : group.solver.symmetric(first + k, first + k);
    });
  }
}

/// Whether a group's contacts are of faces that share their loads.
bool ContactSolver::sharesLoads(const Group& group) const {
  const std::vector<int>& contacts = group.members.contacts;
  const auto pairOf = [&](std::size_t i) {
    const Joint& joint = contactJoints_[index(contacts[i])];
    return std::minmax(joint.bodyA, joint.bodyB);
  };
  const auto normalOf = [&](std::size_t i) -> const Vec3& { return kinematics_[index(contacts[i])].normal; };
  return group.hasNoLoop && areOfFaces(contacts.size(), pairOf, normalOf);
}

/// The matrix of a group in which contacts slide: columns differ with friction alone.
void ContactSolver::coupleFriction(Group& group, const std::vector<BodyFrame>& frames, double time) {
  MinimumNormSolver& solver = group.solver;
  for (const int contact : group.members.contacts) {
    ActiveBlock& column = blocks_[index(contact)];
    const int first = column.firstRow;
    if (contacts_[index(contact)].motion != ContactMotion::sliding) {
      for (int k = first; k < first + column.rows.block.rows; ++k)
        for (int i = 0; i < group.rows; ++i) solver.coupled(i, k) = solver.symmetric(i, k);
      continue;
    }
    addFriction(group, index(contact), frames, time);
    for (const int other : group.members.contacts) {
      const ActiveBlock& row = blocks_[index(other)];
      withContactRows(row.rows.block.rows, [&](auto rows) {
        const auto entries = entriesOf<rows, 1>(group, row.rows.block, column.push);
        for (int i = 0; i < rows; ++i) solver.coupled(row.firstRow + i, first) = entries[i];
      });
    }
  }
}

/// Joins friction to the normal force of a contact that slides.
void ContactSolver::addFriction(Group& group, std::size_t contact, const std::vector<BodyFrame>& frames, double time) {
  const ContactKinematics& place = kinematics_[contact];
  forces_[contact].slidingDirection = slidingDirection(contacts_[contact], place, frames, time);
  const Vec3 force = -contacts_[contact].friction * forces_[contact].slidingDirection;
  Response& push = blocks_[contact].push;
  const ConstraintBlock& normal = blocks_[contact].rows.block;
  push.block.bodyA = normal.bodyA, push.block.bodyB = normal.bodyB;
  push.block.turnsA = normal.turnsA, push.block.turnsB = normal.turnsB;
  push.block.rows = 1;
  push.block.linear.row(0) = place.normal + force;
  push.block.angularA.row(0) = place.leverA + place.armA.cross(force);
  push.block.angularB.row(0) = -place.leverB - place.armB.cross(force);
  findResponse(group, frames, push);
}

/// Adds to a motion (accelerations, velocities, or displacements in their place) what the rows of a group and its
/// constraints ask for: constrain(solver, motion) does what the constraints alone ask, and a row of a block has the
/// rate -asked(block, row).
template <class Constrain, class Asked>
void ContactSolver::solve(Group& group, const Constrain& constrain, const Asked& asked, VectorX& motion) {
  if (group.constraints) {
    free_ = motion;
    constrain(*group.constraints, free_);
  }
  const VectorX& free = group.constraints ? free_ : motion;
  for (const int contact : group.members.contacts) {
    const ActiveBlock& from = blocks_[index(contact)];
    double* const multipliers = &multipliers_[index(from.firstRow)];
    withContactRows(from.rows.block.rows, [&](auto rows) {
      findRates<rows>(from.rows.block, free, multipliers);
      for (std::size_t i = 0; i < rows; ++i) multipliers[i] = -(multipliers[i] + asked(from.rows.block, i));
    });
  }
  group.asked = VectorX::Map(multipliers_.data(), group.rows).cwiseAbs().maxCoeff();
  group.solver.solve(multipliers_.data());
  for (const int contact : group.members.contacts) {
    const ActiveBlock& from = blocks_[index(contact)];
    const bool slides = group.solver.isCoupled() && contacts_[index(contact)].motion == ContactMotion::sliding;
    const Response& response = slides ? from.push : from.rows;
    addResponse(response.block, response.alone, &multipliers_[index(from.firstRow)], motion);
  }
  if (group.constraints) constrain(*group.constraints, motion);
}

void ContactSolver::constrainAccelerations(VectorX& derivative) {
  for (Group& group : groups_) {
    solve(
        group, [](ConstraintSolver& constraints, VectorX& motion) { constraints.constrainAccelerations(motion); },
        [](const ConstraintBlock& block, std::size_t row) { return block.velocityProduct[row]; }, derivative);
    takeForces(group, derivative);
  }
  if (!hasFreeConstraints_) return;
  constraintSolver_.constrainAccelerations(derivative);
  constraintSolver_.putMultipliers(bilateralMultipliers_);
}

/// Notes the forces that go with a group's multipliers, and what friction takes.
void ContactSolver::takeForces(const Group& group, VectorX& derivative) {
  for (const int i : group.members.contacts) {
    const ContactConstraint& contact = contacts_[index(i)];
    const ConstraintBlock& block = blocks_[index(i)].rows.block;
    const double* const multipliers = &multipliers_[index(blocks_[index(i)].firstRow)];
    ContactForce& force = forces_[index(i)];
    force.normal = multipliers[block.rows - 1];
    force.left = 0;
    if (contact.motion == ContactMotion::sliding) {
      force.tangential = -contact.friction * force.normal * force.slidingDirection;
      frictionEnergy(derivative) -= force.tangential.dot(force.tangentialVelocity);
    }
    if (contact.motion != ContactMotion::sticking) continue;
    force.tangential.setZero();  // those of a call before, with other accelerations
    for (int k = 0; k + 1 < block.rows; ++k) force.tangential += multipliers[k] * block.linear.row(k).transpose();
  }
  if (group.constraints) group.constraints->putMultipliers(bilateralMultipliers_);
  if (group.solver.rank() < group.rows) takeContradictions(group, derivative);
}

/// Notes what a group's rows leave of the accelerations that they forbid.
void ContactSolver::takeContradictions(const Group& group, const VectorX& derivative) {
  for (const int i : group.members.contacts) {
    const ConstraintBlock& block = blocks_[index(i)].rows.block;
    ContactForce& force = forces_[index(i)];
    force.asked = group.asked;
    withContactRows(block.rows, [&](auto rows) {
      std::array<double, rows> rates;
      findRates<rows>(block, derivative, rates.data());
      for (std::size_t k = 0; k < rows; ++k)
        force.left = std::max(force.left, std::abs(rates[k] + block.velocityProduct[k]));
    });
  }
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
        group, [](ConstraintSolver& constraints, VectorX& motion) { constraints.constrainVelocities(motion); },
        [](const ConstraintBlock&, std::size_t) { return 0.0; }, state);
}

double ContactSolver::project(VectorX& state, const std::vector<char>& resting) {
  placeGaps(state, resting);
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
    placeGaps(state, resting);
    bool isUndone = false;
    for (Group& group : groups_)
      if (!group.isPlaced) isUndone = judge(group, state) || isUndone;
    if (isUndone) placeGaps(state, resting);
  }
  findBlocks(frames_, true);
  for (Group& group : groups_) {
    couple(group);
    group.solver.factorize(group.rows, false);
  }
  if (hasFreeConstraints_) found = std::max(found, constraintSolver_.project(state));
  constrainGroupVelocities(state);
  return found;
}

void ContactSolver::placeGaps(const VectorX& state, const std::vector<char>& resting) {
  findBodyFrames(bodies_, state, frames_);
  place(state, frames_, resting);
  findBlocks(frames_, false);
}

double ContactSolver::errorOf(const Group& group) const {
  double error = group.constraints ? group.constraints->largestError() : 0;
  for (const int contact : group.members.contacts) error = std::max(error, std::abs(kinematics_[index(contact)].gap));
  return error;
}

bool ContactSolver::isRounding(const Group& group) const {
  const std::vector<int>& contacts = group.members.contacts;
  return (!group.constraints || group.constraints->holdToRounding()) &&
         std::all_of(contacts.begin(), contacts.end(), [this](int contact) {
           const ContactKinematics& place = kinematics_[index(contact)];
           return std::abs(place.gap) <= place.rounding;
         });
}

/// One step of Newton's method.
void ContactSolver::displace(Group& group, VectorX& state) {
  couple(group);
  group.solver.factorize(group.rows, false);
  displacement_.setZero(state.size());
  solve(
      group, [](ConstraintSolver& constraints, VectorX& motion) { constraints.constrainDisplacements(motion); },
      [](const ConstraintBlock& block, std::size_t row) { return block.value[row]; }, displacement_);
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
