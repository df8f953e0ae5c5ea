#include "simulate/event_contacts.h"

#include <algorithm>
#include <cmath>

#include "collision/core.h"
#include "dynamics/invariants.h"
#include "impact/cone_problem.h"
#include "impact/contact_impulse.h"
#include "impact/frictional_impact.h"
#include "impact/generalized_reflections.h"
#include "simulate/contact_response.h"

namespace cradle {
namespace {

constexpr double kTouchPart = 0.1;         // of the accuracy, in sizes of a body: nearer is touching ...
constexpr double kLeastTouchPart = 1e-11;  // ... but not within rounding
constexpr double kMostTouchPart = 1e-8;
constexpr double kMostTouchError = 1e-6;   // of a size: so well two ways to find a gap agree
constexpr double kDeadBandPart = 1e-12;    // of the smallest size
constexpr double kStandstillPart = 1e-12;  // of the fastest speed at an impact: what is left is rounding
constexpr double kLastBouncePart = 1e-7;   // of sqrt(acceleration x size): bounces lower than 5e-15 of the size
constexpr double kMostStillPart = 1e-7;    // of sqrt(g x size)
constexpr double kMostResidual = 1e-6;     // of gravity: what forces may leave of bodies at rest
constexpr double kSameCorner = 1e-6;       // of a size
constexpr double kSpeedRounding = 1e-12;   // m/s

double smallestSize(const ContactGeometry& geometry) {
  double smallest = INFINITY;
  for (const Collider& collider : geometry.colliders)
    if (collider.body != kFixed) smallest = std::min(smallest, collider.boundingRadius);
  return std::isfinite(smallest) ? smallest : 1;
}

double openingSpeed(const Contact& contact, const VectorX& state) {
  return contact.normal.dot(relativeVelocity(contact, state));
}

/// The fastest that any point moves at a contact, in m/s.
double contactSpeed(const Contact& contact, const VectorX& state) {
  double speed = 0;
  for (const int body : {contact.bodyA, contact.bodyB})
    if (body != kFixed) speed = std::max(speed, linearVelocity(state, body).norm());
  return speed;
}

double openingAcceleration(const Contact& contact, const VectorX& state, const VectorX& rate) {
  return contact.normal.dot(pointAcceleration(contact.bodyB, contact.point, state, rate) -
                            pointAcceleration(contact.bodyA, contact.point, state, rate));
}

/// Whether a collider with corners has one at `point` (m, world).
bool hasCornerAt(const Collider& collider, const Vec3& point, const VectorX& state) {
  if (collider.radius > 0) return false;
  const Vec3 local = poseOf(state, collider.body).inverse() * point;
  const double near = kSameCorner * collider.boundingRadius;
  if (collider.kind() == ColliderKind::cylinder) {  // any point of a rim
    const Core core(collider, {});
    const double side = core.axis().dot(local - core.center()) < 0 ? -1 : 1;
    return (core.rimPoint(side, local - core.center()) - local).squaredNorm() < near * near;
  }
  return std::any_of(collider.points.begin(), collider.points.end(),
                     [&](const Vec3& corner) { return (corner - local).squaredNorm() < near * near; });
}

/// Where two flat faces touch, a contact may be a corner of either of them; where their edges cross it is none.
void findCorner(const ContactGeometry& geometry, const VectorX& state, Contact& contact) {
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const double least = std::min(contact.radiusA, contact.radiusB), most = std::max(contact.radiusA, contact.radiusB);
  if (pair.againstPlane || least != 0 || !std::isinf(most)) return;
  contact.radiusA = contact.radiusB = INFINITY;
  if (hasCornerAt(geometry.colliders[pair.a], contact.point, state))
    contact.radiusA = 0;
  else if (hasCornerAt(geometry.colliders[pair.b], contact.point, state))
    contact.radiusB = 0;
}

int movingBodyOf(const Contact& contact) {
  return contact.bodyA != kFixed ? contact.bodyA : contact.bodyB;
}

}  // namespace

EventContacts::EventContacts(MovingIsland& island, double accuracy)
    : island_(island),
      lasting_(island),
      solver_(island.assembly.mechanism.constraints, island.assembly.mechanism.bodies),
      stillPart_(std::min(kMostStillPart, accuracy)) {
  size_ = smallestSize(island.assembly.geometry);
  touchTolerance_ = size_ * std::clamp(kTouchPart * accuracy, kLeastTouchPart, kMostTouchPart);
  deadBand_ = kDeadBandPart * size_;
}

TouchingFeatures EventContacts::touching() {
  return {touchTolerance_, deadBand_, &lasting_.held()};
}

void EventContacts::resolve(const std::optional<ContactChange>& change, const std::optional<std::size_t>& meeting) {
  if (!island_.mayTouch()) return;
  std::vector<char> rested;
  for (std::size_t body = 0; body < island_.assembly.mechanism.bodies.size(); ++body)
    rested.push_back(island_.equations.isResting(body));
  restDelay_ = 0;
  findTouching(meeting);
  if (solver_.hasConstraints()) solver_.factorize(island_.state);
  collide();
  lasting_.letGo(change);
  settle();
  lasting_.decide(touching_, solver_);
  keepTogether();
  if (!lasting_.empty() && isAnySlow()) {  // what sticks is still now
    settle();
    lasting_.letGoResting();
  }
  recordRests(rested);
}

/// Lasting contacts have no gap and do not leave each other, to rounding; those that stick do not slide.
void EventContacts::keepTogether() {
  if (lasting_.empty()) return;
  VectorX& state = island_.state;
  const double before = kineticEnergy(island_.assembly.mechanism.bodies, state);
  island_.equations.project(state);
  dissipatedEnergy(state) += before - kineticEnergy(island_.assembly.mechanism.bodies, state);
}

/// What meets now touches, if its gap is known to that or not.
void EventContacts::findTouching(const std::optional<std::size_t>& meeting) {
  const ContactGeometry& geometry = island_.assembly.geometry;
  findContacts(geometry, island_.state, touchTolerance_, touching_);
  const auto isOfMeeting = [&](const Contact& contact) { return contact.pair == *meeting; };
  if (!meeting || std::any_of(touching_.begin(), touching_.end(), isOfMeeting)) return findCorners();
  std::vector<Contact> near;
  appendContacts(geometry, *meeting, island_.state, kMostTouchError * size_, near);
  const auto nearest = std::min_element(near.begin(), near.end(), [](const Contact& left, const Contact& right) {
    return left.separation < right.separation;
  });
  if (nearest != near.end()) touching_.push_back(*nearest);
  findCorners();
}

void EventContacts::findCorners() {
  for (Contact& contact : touching_) findCorner(island_.assembly.geometry, island_.state, contact);
}

/// Contacts that close are impacts, and then all that touch each other there take part.
void EventContacts::collide() {
  double fastest = 0;
  for (const Contact& contact : touching_) fastest = std::max(fastest, contactSpeed(contact, island_.state));
  const Islands together = findStruckTogether();
  std::vector<char> isStruck(island_.assembly.mechanism.bodies.size(), 0);
  for (const Contact& contact : touching_)
    if (openingSpeed(contact, island_.state) < -kStandstillPart * fastest)
      isStruck[static_cast<std::size_t>(together.islandOf(movingBodyOf(contact)))] = 1;
  for (std::size_t group = 0; group < isStruck.size(); ++group) {
    if (!isStruck[group]) continue;
    std::vector<ImpactContact> impacts;
    for (const Contact& contact : touching_)
      if (together.islandOf(movingBodyOf(contact)) == static_cast<int>(group))
        impacts.push_back({contact, island_.assembly.geometry.pairs[contact.pair].law, 0, Vec3::Zero()});
    resolveImpact(impacts);
  }
  wakeStruck();
}

/// Bodies that an impact at one of them moves.
Islands EventContacts::findStruckTogether() const {
  Islands islands(island_.assembly.mechanism.bodies.size());
  for (const Contact& contact : touching_) islands.join(contact.bodyA, contact.bodyB);
  forEachTie(island_.assembly.mechanism.constraints, [&](int bodyA, int bodyB) { islands.join(bodyA, bodyB); });
  return islands;
}

void EventContacts::resolveImpact(std::vector<ImpactContact>& impacts) {
  VectorX& state = island_.state;
  const VectorX approach = state;
  const ImpulseResponse response(island_.assembly.mechanism.bodies, solver_);
  const bool hasFriction = std::any_of(impacts.begin(), impacts.end(), [](const ImpactContact& impact) {
    return impact.law.staticFriction > 0 || impact.law.dynamicFriction > 0;
  });
  const auto solve = [&] {
    hasFriction ? resolveFrictionalImpact(impacts, response, state) : resolveReflections(impacts, response, state);
  };
  solve();
  if (endBounces(approach, impacts)) {
    state = approach;
    for (ImpactContact& impact : impacts) impact.impulse.setZero();
    solve();
  }
  for (const ImpactContact& impact : impacts) {
    const Vec3 meanVelocity =
        (relativeVelocity(impact.contact, approach) + relativeVelocity(impact.contact, state)) / 2;
    dissipatedEnergy(state) -= impact.impulse.dot(meanVelocity);
    const double impulse = impact.contact.normal.dot(impact.impulse);
    if (impulse > 0) island_.log.recordContact(island_.time, EventKind::impact, impact.contact, impulse);
  }
}

/// Rebounds that are over before they are seen are left out: an accumulation of bounces ends here, as long before its
/// time as all of them would take. True if there are any.
bool EventContacts::endBounces(const VectorX& approach, std::vector<ImpactContact>& impacts) {
  const VectorX& state = island_.state;
  bool isEvaluated = false, found = false;
  for (ImpactContact& impact : impacts) {
    const double speed = openingSpeed(impact.contact, state), restitution = impact.law.restitution;
    const bool rebounds = openingSpeed(impact.contact, approach) < 0 && speed > 0 && restitution < 1;
    if (!rebounds || restitution == 0) continue;
    if (!isEvaluated) island_.equations.evaluate(state, rate_);
    isEvaluated = true;
    const double closing = -openingAcceleration(impact.contact, state, rate_);
    const double size = island_.assembly.radii[static_cast<std::size_t>(movingBodyOf(impact.contact))];
    if (!(closing > 0) || speed > kLastBouncePart * std::sqrt(closing * size)) continue;
    impact.restSpeed = INFINITY;
    restDelay_ = std::max(restDelay_, 2 * speed / (closing * (1 - restitution)));
    found = true;
  }
  return found;
}

/// Bodies that an impact has set in motion, and all that rests with them.
void EventContacts::wakeStruck() {
  for (const Contact& contact : touching_)
    for (const int body : {contact.bodyA, contact.bodyB})
      if (island_.resting.isResting(body) && !isSlow(static_cast<std::size_t>(body)))
        island_.resting.wake(island_.time, body);
}

bool EventContacts::isAnySlow() const {
  for (std::size_t body = 0; body < island_.assembly.mechanism.bodies.size(); ++body)
    if (!island_.equations.isResting(body) && isSlow(body)) return true;
  return false;
}

bool EventContacts::isSlow(std::size_t body) const {
  const Eigen::Index index = static_cast<Eigen::Index>(body);
  const double size = island_.assembly.radii[body], gravity = island_.assembly.mechanism.gravity.norm();
  const double most = kSpeedRounding + stillPart_ * std::sqrt(gravity * size);
  return std::max(linearVelocity(island_.state, index).norm(), size * angularVelocity(island_.state, index).norm()) <=
         most;
}

/// Bodies that come to rest only together: tied, on a spring, or touching without leaving each other.
Islands EventContacts::findRestGroups() const {
  const Mechanism& mechanism = island_.assembly.mechanism;
  Islands groups(mechanism.bodies.size());
  for (const Contact& contact : touching_) {
    const double size = island_.assembly.radii[static_cast<std::size_t>(movingBodyOf(contact))];
    const double still = kSpeedRounding + stillPart_ * std::sqrt(mechanism.gravity.norm() * size);
    if (openingSpeed(contact, island_.state) <= still) groups.join(contact.bodyA, contact.bodyB);
  }
  for (const SpringForce& spring : mechanism.springs) groups.join(spring.anchorA.body, spring.anchorB.body);
  forEachTie(mechanism.constraints, [&](int bodyA, int bodyB) { groups.join(bodyA, bodyB); });
  return groups;
}

/// Puts groups to rest that are still and that forces within the friction cones can hold; wakes those that are not.
void EventContacts::settle() {
  const std::size_t bodies = island_.assembly.mechanism.bodies.size();
  const Islands groups = findRestGroups();
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
    if (!isAwake[group] || !isStill[group] || !isHeld(groups, static_cast<int>(group))) continue;
    std::vector<int> members;
    for (std::size_t body = 0; body < bodies; ++body)
      if (groupOf(body) == group) members.push_back(static_cast<int>(body));
    if (!members.empty()) island_.resting.bringToRest(members, island_.state);
  }
}

/// Whether forces at the contacts of a group can balance all that acts on it.
bool EventContacts::isHeld(const Islands& groups, int group) {
  const Mechanism& mechanism = island_.assembly.mechanism;
  placeBodies(mechanism.bodies, island_.state, frames_);
  std::vector<ContactRows> contacts;
  std::vector<double> frictions;
  for (const Contact& contact : touching_) {
    if (groups.islandOf(movingBodyOf(contact)) != group) continue;
    contacts.push_back(rowsOf(contact, island_.state, frames_));
    frictions.push_back(island_.assembly.geometry.pairs[contact.pair].law.staticFriction);
  }
  std::vector<ContactConstraint> lasting;
  std::swap(lasting, island_.assembly.mechanism.contacts);
  island_.equations.evaluate(island_.state, rate_);
  std::swap(lasting, island_.assembly.mechanism.contacts);
  if (!contacts.empty()) {
    const ContactResponse response(contacts, mechanism.bodies, frames_, solver_);
    const ConeSolution solution = solveConeProblem(response.inverseMass(), response.accelerations(rate_), frictions);
    response.apply(solution.impulses, rate_);
  }
  const double most = std::min(kMostResidual, stillPart_) * mechanism.gravity.norm();
  for (std::size_t body = 0; body < mechanism.bodies.size(); ++body) {
    if (groups.islandOf(static_cast<int>(body)) != group) continue;
    const Eigen::Index index = static_cast<Eigen::Index>(body);
    const double left = std::max(linearVelocity(rate_, index).norm(),
                                 island_.assembly.radii[body] * angularVelocity(rate_, index).norm());
    if (left > most) return false;
  }
  return true;
}

void EventContacts::recordRests(const std::vector<char>& restedBefore) {
  for (std::size_t body = 0; body < restedBefore.size(); ++body) {
    const bool rests = island_.equations.isResting(body);
    if (rests == static_cast<bool>(restedBefore[body])) continue;
    const double time = island_.time + (rests ? restDelay_ : 0);
    island_.log.recordBody(time, rests ? EventKind::rest : EventKind::wake, static_cast<int>(body),
                           centerOfMass(island_.state, static_cast<Eigen::Index>(body)));
  }
}

}  // namespace cradle
