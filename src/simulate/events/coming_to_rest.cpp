#include "simulate/events/coming_to_rest.h"

#include <algorithm>

#include "constraints/dense_delassus.h"
#include "impact/frictional_contact.h"

namespace cradle {

bool ComingToRest::isAnySlow() const {
  for (std::size_t body = 0; body < island_.assembly.mechanism.bodies.size(); ++body)
    if (!island_.equations.isResting(body) && isSlow(body)) return true;
  return false;
}

double ComingToRest::sizeOf(std::size_t body) const {
  const double radius = island_.assembly.radii[body];
  return radius > 0 ? radius : gyrationRadius(island_.assembly.mechanism.bodies[body]);
}

bool ComingToRest::isSlow(std::size_t body) const {
  const Eigen::Index index = static_cast<Eigen::Index>(body);
  const Mechanism& mechanism = island_.assembly.mechanism;
  if (mechanism.bodies[body].isDriven()) return isDrivenStill(mechanism.driven, static_cast<int>(body), island_.time);
  const double size = sizeOf(body);
  return std::max(linearVelocity(island_.state, index).norm(), size * angularVelocity(island_.state, index).norm()) <=
         tolerances_.maxRestSpeed(size);
}

/// Bodies that come to rest only together: joined, at the ends of a spring, or in a contact that does not open.
DisjointSets ComingToRest::findRestGroups(const std::vector<Contact>& touching) const {
  const Mechanism& mechanism = island_.assembly.mechanism;
  DisjointSets groups(mechanism.bodies.size());
  for (const Contact& contact : touching) {
    const double still = tolerances_.maxRestSpeed(smallestSize(contact, island_.assembly.radii));
    if (openingSpeed(contact, island_.state) <= still) groups.join(contact.bodyA, contact.bodyB);
  }
  for (const SpringForce& spring : mechanism.springs) groups.join(spring.anchorA.body, spring.anchorB.body);
  for (const Constraint& constraint : mechanism.constraints)
    groups.join(constraint.anchorA.body, constraint.anchorB.body);
  return groups;
}

void ComingToRest::letSleep(const std::vector<Contact>& touching) {
  if (!island_.resting.anyRests() && !isAnySlow()) return;
  const std::size_t bodies = island_.assembly.mechanism.bodies.size();
  const DisjointSets groups = findRestGroups(touching);
  const auto groupOf = [&](std::size_t body) {
    return static_cast<std::size_t>(groups.islandOf(static_cast<int>(body)));
  };
  std::vector<char> isStill(bodies, 1), isAwake(bodies, 0);
  for (std::size_t body = 0; body < bodies; ++body) {
    if (!isSlow(body)) isStill[groupOf(body)] = 0;
    if (!island_.equations.isResting(body)) isAwake[groupOf(body)] = 1;
  }
  // Bodies that rested together may be in several groups now.
  for (bool woken = true; woken;) {
    woken = false;
    for (std::size_t body = 0; body < bodies; ++body)
      if (isAwake[groupOf(body)])
        for (const int other : island_.resting.wake(island_.time, static_cast<int>(body)))
          isAwake[groupOf(static_cast<std::size_t>(other))] = 1, woken = true;
  }
  std::vector<std::vector<int>> members(bodies);
  for (std::size_t body = 0; body < bodies; ++body) members[groupOf(body)].push_back(static_cast<int>(body));
  std::vector<std::vector<std::size_t>> contacts(bodies);
  for (std::size_t i = 0; i < touching.size(); ++i)
    contacts[groupOf(static_cast<std::size_t>(touching[i].movingBody()))].push_back(i);
  std::optional<FreeMotion> motion;  // until what it depends on changes: one for many groups takes long
  const bool areTied = !island_.assembly.mechanism.constraints.empty();
  for (std::size_t group = 0; group < bodies; ++group) {
    if (!isAwake[group] || !isStill[group]) continue;
    const std::vector<JointMotor> motors = island_.assembly.mechanism.motors;
    const bool isPushed = pushTowardsTargets(groups, static_cast<int>(group));
    if (isPushed || !motion) motion = freeMotion();
    const Group still{static_cast<int>(group), members[group], contacts[group]};
    const auto supports = findEquilibrium(touching, groups, still, *motion);
    if (!supports) island_.assembly.mechanism.motors = motors;
    if (supports && !members[group].empty()) island_.resting.bringToRest(members[group], island_.state, *supports);
    if (isPushed || (supports && areTied)) motion.reset();
  }
}

ComingToRest::FreeMotion ComingToRest::freeMotion() const {
  FreeMotion motion;
  island_.equations.evaluateWithoutContacts(island_.time, island_.state, motion.derivative);
  findBodyFrames(island_.assembly.mechanism.bodies, island_.state, motion.frames);
  return motion;
}

/// Motors of a group that stands have all their force for another target than rest, whatever they did before.
bool ComingToRest::pushTowardsTargets(const DisjointSets& groups, int group) {
  bool isAny = false;
  for (JointMotor& motor : island_.assembly.mechanism.motors) {
    const int a = motor.joint.anchorA.body, b = motor.joint.anchorB.body;
    if (!motor.hasTarget || motor.targetVelocity == 0 || groups.islandOf(a == kFixed ? b : a) != group) continue;
    motor.mode = JointMotor::Mode::pushes;
    motor.sign = motor.targetVelocity < 0 ? -1 : 1;
    isAny = true;
  }
  return isAny;
}

/// The contact forces within the friction cones that balance all that acts on a group, with those of constraints: none
/// where these do so alone. Null if nothing does. Adds what contacts do to the group's part of `motion`.
std::optional<std::vector<SupportForce>> ComingToRest::findEquilibrium(const std::vector<Contact>& touching,
                                                                       const DisjointSets& groups, const Group& group,
                                                                       FreeMotion& motion) {
  const Mechanism& mechanism = island_.assembly.mechanism;
  auto& [derivative, frames] = motion;
  std::vector<ContactRows> contacts;
  std::vector<SupportForce> supports;
  if (isInEquilibrium(derivative, group, tolerances_.maxRestAcceleration(0))) {
    if (!doLimitsHold(contacts, VectorX(), frames, groups, group.number)) return std::nullopt;
    return supports;
  }
  std::vector<double> frictions;
  const auto leaves = [&](int body) {  // what is driven carries nothing that it does not go with
    return body != kFixed && mechanism.bodies[static_cast<std::size_t>(body)].isDriven() &&
           groups.islandOf(body) != group.number;
  };
  for (const std::size_t index : group.contacts) {
    const Contact& contact = touching[index];
    if (leaves(contact.bodyB)) continue;
    contacts.push_back(rowsOf(contact, island_.state, frames));
    supports.push_back({contact, island_.assembly.geometry.pairs[contact.pair], Vec3::Zero()});
    frictions.push_back(supports.back().pair.material.staticFriction);
  }
  if (contacts.empty()) return std::nullopt;
  const DenseDelassus delassus(blocksOf(contacts), mechanism.bodies, frames, &constraints_);
  const ContactSolution solution =
      solveFrictionalContact(delassus.matrix(), delassus.accelerations(derivative), frictions);
  delassus.apply(solution.impulses, derivative);
  if (!isInEquilibrium(derivative, group, tolerances_.maxRestAcceleration(solution.residual)) ||
      !doLimitsHold(contacts, solution.impulses, frames, groups, group.number))
    return std::nullopt;
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const ConstraintBlock& block = contacts[i].block;
    const Vec3 onFirst =
        block.linear.topRows<3>().transpose() * solution.impulses.segment<3>(3 * static_cast<Eigen::Index>(i));
    supports[i].force = block.bodyA == supports[i].contact.bodyA ? Vec3(-onFirst) : onFirst;
  }
  return supports;
}

/// Whether ropes and stops that are constraints in an equilibrium with these forces of contacts pull there, rather than
/// push. (Of several ways to share a load those of the least forces are found.)
bool ComingToRest::doLimitsHold(const std::vector<ContactRows>& contacts, const VectorX& impulses,
                                const std::vector<BodyFrame>& frames, const DisjointSets& groups, int group) {
  const std::vector<Limit>& limits = island_.assembly.limits;
  const std::vector<int>& rows = limits_.tautRows();
  if (std::all_of(rows.begin(), rows.end(), [](int row) { return row < 0; })) return true;
  Mechanism& mechanism = island_.assembly.mechanism;
  Constraints constraints;
  std::swap(constraints, mechanism.constraints);
  VectorX derivative;
  island_.equations.evaluateWithoutContacts(island_.time, island_.state, derivative);
  std::swap(constraints, mechanism.constraints);
  if (!contacts.empty())
    DenseDelassus(blocksOf(contacts), mechanism.bodies, frames, nullptr).apply(impulses, derivative);
  constraints_.constrainAccelerations(derivative);
  VectorX multipliers = VectorX::Zero(rowCount(mechanism.constraints));
  constraints_.putMultipliers(multipliers);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const auto [a, b] = bodiesOf(limits[i]);
    if (rows[i] < 0 || groups.islandOf(a == kFixed ? b : a) != group) continue;
    double mass = 0;  // kg, of the heavier
    for (const int body : {a, b})
      if (body != kFixed) mass = std::max(mass, mechanism.bodies[static_cast<std::size_t>(body)].mass);
    if (tensionOf(limits[i], multipliers[rows[i]]) < -tolerances_.maxRestAcceleration(0) * mass) return false;
  }
  return true;
}

/// Whether the accelerations of a state derivative are below `most` (m/s^2) for all bodies of a group.
bool ComingToRest::isInEquilibrium(const VectorX& derivative, const Group& group, double most) const {
  for (const int body : group.bodies) {
    const Eigen::Index index = body;
    const double left = std::max(linearVelocity(derivative, index).norm(),
                                 sizeOf(static_cast<std::size_t>(body)) * angularVelocity(derivative, index).norm());
    if (left > most) return false;
  }
  return true;
}

void ComingToRest::wakeStruck(const Contact& contact) {
  for (const int body : {contact.bodyA, contact.bodyB})
    if (body != kFixed && island_.resting.isResting(body) && !isSlow(static_cast<std::size_t>(body)))
      island_.resting.wake(island_.time, body);
}

}  // namespace cradle
