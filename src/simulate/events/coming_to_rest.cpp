// Which bodies an event brings to rest: those that are still, touch each other, and are held by forces within the
// friction cones.

#include <algorithm>
#include <cmath>

#include "impact/contact_impulse.h"
#include "impact/frictional_contact.h"
#include "simulate/contact_response.h"
#include "simulate/events/event_contacts.h"
#include "simulate/thresholds.h"

namespace cradle {

bool EventContacts::isAnySlow() const {
  for (std::size_t body = 0; body < island_.assembly.mechanism.bodies.size(); ++body)
    if (!island_.equations.isResting(body) && isSlow(body)) return true;
  return false;
}

bool EventContacts::isSlow(std::size_t body) const {
  const Eigen::Index index = static_cast<Eigen::Index>(body);
  const double size = island_.assembly.radii[body], gravity = island_.assembly.mechanism.gravity.norm();
  const double most = kRestSpeedFloor + stillPart_ * std::sqrt(gravity * size);
  return std::max(linearVelocity(island_.state, index).norm(), size * angularVelocity(island_.state, index).norm()) <=
         most;
}

/// Bodies that come to rest only together: joined, on a spring, or touching without leaving each other.
DisjointSets EventContacts::findRestGroups() const {
  const Mechanism& mechanism = island_.assembly.mechanism;
  DisjointSets groups(mechanism.bodies.size());
  for (const Contact& contact : touching_) {
    const double size = smallestSize(contact, island_.assembly.radii);
    const double still = kRestSpeedFloor + stillPart_ * std::sqrt(mechanism.gravity.norm() * size);
    if (openingSpeed(contact, island_.state) <= still) groups.join(contact.bodyA, contact.bodyB);
  }
  for (const SpringForce& spring : mechanism.springs) groups.join(spring.anchorA.body, spring.anchorB.body);
  forEachConstraint(mechanism.constraints, [&](int bodyA, int bodyB) { groups.join(bodyA, bodyB); });
  return groups;
}

/// Puts groups to rest that are still and that forces within the friction cones can hold; wakes those that are not.
void EventContacts::letSleep() {
  if (!island_.resting.anyRests() && !isAnySlow()) return;
  const std::size_t bodies = island_.assembly.mechanism.bodies.size();
  const DisjointSets groups = findRestGroups();
  const auto groupOf = [&](std::size_t body) {
    return static_cast<std::size_t>(groups.islandOf(static_cast<int>(body)));
  };
  std::vector<char> isStill(bodies, 1), isAwake(bodies, 0);
  for (std::size_t body = 0; body < bodies; ++body) {
    if (!isSlow(body)) isStill[groupOf(body)] = 0;
    if (!island_.equations.isResting(body)) isAwake[groupOf(body)] = 1;
  }
  // What rested together may stand in several groups now.
  for (bool woken = true; woken;) {
    woken = false;
    for (std::size_t body = 0; body < bodies; ++body)
      if (isAwake[groupOf(body)])
        for (const int other : island_.resting.wake(island_.time, static_cast<int>(body)))
          isAwake[groupOf(static_cast<std::size_t>(other))] = 1, woken = true;
  }
  for (std::size_t group = 0; group < bodies; ++group) {
    if (!isAwake[group] || !isStill[group] || !canBeInEquilibrium(groups, static_cast<int>(group))) continue;
    std::vector<int> members;
    for (std::size_t body = 0; body < bodies; ++body)
      if (groupOf(body) == group) members.push_back(static_cast<int>(body));
    if (!members.empty()) island_.resting.bringToRest(members, island_.state);
  }
}

/// Whether forces at the contacts of a group can balance all that acts on it, if constraints alone do not.
bool EventContacts::canBeInEquilibrium(const DisjointSets& groups, int group) {
  const Mechanism& mechanism = island_.assembly.mechanism;
  std::vector<ContactConstraint> active;
  std::swap(active, island_.assembly.mechanism.contacts);
  island_.equations.evaluate(island_.state, derivative_);
  std::swap(active, island_.assembly.mechanism.contacts);
  const double gravity = mechanism.gravity.norm(), most = stillPart_ * gravity;
  const auto still = [&](double residual) {
    return std::min(most, stillAcceleration(island_.scene.accuracy, island_.scene.duration, gravity, residual));
  };
  if (isInEquilibrium(groups, group, still(0))) return true;
  findBodyFrames(mechanism.bodies, island_.state, frames_);
  std::vector<ContactRows> contacts;
  std::vector<double> frictions;
  for (const Contact& contact : touching_) {
    if (groups.islandOf(contact.movingBody()) != group) continue;
    contacts.push_back(rowsOf(contact, island_.state, frames_));
    frictions.push_back(island_.assembly.geometry.pairs[contact.pair].material.staticFriction);
  }
  if (contacts.empty()) return false;
  const ContactResponse response(contacts, mechanism.bodies, frames_, solver_);
  const ContactSolution solution =
      solveFrictionalContact(response.delassus(), response.accelerations(derivative_), frictions);
  response.apply(solution.impulses, derivative_);
  return isInEquilibrium(groups, group, still(solution.residual));
}

/// Whether the accelerations in derivative_ leave the bodies of a group where they are, but for `most` (m/s^2).
bool EventContacts::isInEquilibrium(const DisjointSets& groups, int group, double most) const {
  const Mechanism& mechanism = island_.assembly.mechanism;
  for (std::size_t body = 0; body < mechanism.bodies.size(); ++body) {
    if (groups.islandOf(static_cast<int>(body)) != group) continue;
    const Eigen::Index index = static_cast<Eigen::Index>(body);
    const double left = std::max(linearVelocity(derivative_, index).norm(),
                                 island_.assembly.radii[body] * angularVelocity(derivative_, index).norm());
    if (left > most) return false;
  }
  return true;
}

}  // namespace cradle
