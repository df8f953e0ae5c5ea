#include "simulate/events/event_contacts.h"

#include <algorithm>
#include <cmath>

#include "collision/core.h"
#include "dynamics/invariants.h"
#include "impact/contact_impulse.h"
#include "impact/frictional_impact.h"
#include "impact/generalized_reflections.h"
#include "impact/impact_energy.h"
#include "simulate/contact_response.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

// Nearer (in sizes of a body) is touching: hardly more than rounding, whatever the accuracy, as what comes of a gap and
// of none may differ by everything. A look takes more together.
constexpr double kTouchRatio = 1e-11;
constexpr double kVisualTouchRatio = 1e-8;
// In a sequence of impacts bodies move so far at most while normals stay as they are; farther where a look is enough,
// as events are counted there.
constexpr double kReachRatio = 0.1;  // of the accuracy
constexpr double kMaxReachRatio = 1e-8;
constexpr double kMaxVisualReachRatio = 1e-5;
constexpr double kMaxTouchError = 1e-6;     // of a size: so well two ways to find a gap agree
constexpr double kDeadBandRatio = 1e-12;    // of the smallest size
constexpr double kBounceOfAccuracy = 1e-2;  // the same, of the accuracy ...
constexpr double kBounceOfSquare = 100;     // ... or of its square, if that is more: 5e-5 of the size at the coarsest
constexpr double kMaxStillRatio = 1e-7;     // of sqrt(g x size)
constexpr double kSameCorner = 1e-6;        // of a size
constexpr double kShortMomentArm = 3e-4;    // sizes of a body: hinges of flaps are a thousandth inside their edges ...
constexpr double kUnboundedMomentArm = 3e-3;  // ... and where forces grow without bound, such levers are why

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

/// A tilted cylinder on a plane touches by the lowest point of a disc, which rolls along its rim.
void findRim(const ContactGeometry& geometry, const VectorX& state, Contact& contact) {
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const Collider& cylinder = geometry.colliders[pair.a];
  if (!pair.againstPlane || cylinder.kind() != ColliderKind::cylinder || !std::isnan(contact.radiusA)) return;
  const Core core(cylinder, poseOf(state, cylinder.body));
  if (core.axis().cross(contact.normal).norm() < kFlatRim) return;
  const double side = core.axis().dot(contact.point - core.center()) < 0 ? -1 : 1;
  const Vec3 lowest = core.rimPoint(side, contact.normal);
  contact.point = lowest + contact.separation / 2 * contact.normal;
  contact.radiusA = cylinder.rimRadius, contact.rimAxisA = core.axis();
}

/// Whether two contacts are at the lowest point of one rim.
bool isSameRim(const Contact& one, const Contact& other) {
  return one.pair == other.pair && !one.rimAxisA.isZero(0) && one.rimAxisA == other.rimAxisA &&
         one.point == other.point;
}

}  // namespace

EventContacts::EventContacts(IslandState& island, RopeEvents& ropes, double accuracy, bool isTrial)
    : island_(island),
      ropes_(ropes),
      size_(smallestSize(island.assembly.geometry)),
      touchTolerance_(size_ * (accuracy > kVisualAccuracy ? kVisualTouchRatio : kTouchRatio)),
      deadBand_(kDeadBandRatio * size_),
      reach_(size_ * std::clamp(kReachRatio * accuracy, kTouchRatio,
                                accuracy > kVisualAccuracy ? kMaxVisualReachRatio : kMaxReachRatio)),
      active_(island, touchTolerance_),
      solver_(island.assembly.mechanism.constraints, island.assembly.mechanism.bodies),
      stillPart_(std::min(kMaxStillRatio, accuracy)),
      shortMomentArm_(isTrial ? kUnboundedMomentArm : kShortMomentArm) {}

TouchingFeatures EventContacts::touching() {
  return {touchTolerance_, deadBand_, &active_.features()};
}

void EventContacts::resolve(const std::optional<ContactChange>& change, const std::optional<std::size_t>& closingPair) {
  if (!island_.mayTouch()) return;
  std::vector<char> rested;
  for (std::size_t body = 0; body < island_.assembly.mechanism.bodies.size(); ++body)
    rested.push_back(island_.equations.isResting(body));
  zenoTime_ = 0;
  if (solver_.hasConstraints()) solver_.factorize(island_.state);
  findTouching(closingPair);
  collide(closingPair);
  active_.release(change);
  letSleep();
  active_.classify(touching_, solver_);
  active_.noteShortMomentArms(touching_, solver_, shortMomentArm_);
  project();
  if (!active_.empty() && isAnySlow()) {  // what sticks is still now
    letSleep();
    active_.releaseResting();
  }
  recordRests(rested);
}

void EventContacts::noteShortMomentArms() {
  noteShortMomentArms(shortMomentArm_);
}

bool EventContacts::noteUnboundedForces() {
  if (!active_.noteJam()) noteShortMomentArms(kUnboundedMomentArm);
  return !active_.fallbackReason().empty();
}

void EventContacts::noteShortMomentArms(double lever) {
  if (active_.empty() || !solver_.hasConstraints()) return;
  solver_.factorize(island_.state);
  findTouching({});
  active_.noteShortMomentArms(touching_, solver_, lever);
}

/// Active contacts have no gap and do not leave each other, to rounding; those that stick do not slide. What cannot
/// last, as two corners that meet, has no rows for that.
void EventContacts::project() {
  if (active_.empty() || !active_.fallbackReason().empty()) return;
  const double constant = energyConstant(island_.assembly.mechanism, island_.state);
  island_.equations.project(island_.state);
  bookNumerical(constant, island_.assembly.mechanism, island_.state);
}

/// What touches and can part or close: a place that constraints hold where it is does neither, whatever acts.
void EventContacts::findTouching(const std::optional<std::size_t>& closingPair) {
  findNear(closingPair);
  eraseImmobile(ImpulseResponse(island_.assembly.mechanism.bodies, solver_), island_.state, touching_);
  for (Contact& contact : touching_) findCorner(island_.assembly.geometry, island_.state, contact);
  for (Contact& contact : touching_) findRim(island_.assembly.geometry, island_.state, contact);
  touching_.erase(std::unique(touching_.begin(), touching_.end(), isSameRim), touching_.end());
}

/// What meets now touches, if its gap is known to that or not.
void EventContacts::findNear(const std::optional<std::size_t>& closingPair) {
  const ContactGeometry& geometry = island_.assembly.geometry;
  findContacts(geometry, island_.state, touchTolerance_, touching_);
  const auto isOfClosingPair = [&](const Contact& contact) { return contact.pair == *closingPair; };
  if (!closingPair || std::any_of(touching_.begin(), touching_.end(), isOfClosingPair)) return;
  std::vector<Contact> near;
  appendContacts(geometry, *closingPair, island_.state, kMaxTouchError * size_, near);
  const auto nearest = std::min_element(near.begin(), near.end(), [](const Contact& left, const Contact& right) {
    return left.separation < right.separation;
  });
  if (nearest != near.end()) touching_.push_back(*nearest);
}

void EventContacts::resolveImpact(std::vector<ImpactContact>& impacts) {
  VectorX& state = island_.state;
  const VectorX approach = state;
  const ImpulseResponse response(island_.assembly.mechanism.bodies, solver_);
  const bool hasFriction = std::any_of(impacts.begin(), impacts.end(), [](const ImpactContact& impact) {
    return impact.material.staticFriction > 0 || impact.material.dynamicFriction > 0;
  });
  ImpactFaults faults;
  const auto solve = [&] {
    if (hasFriction)
      faults = resolveFrictionalImpact(impacts, response, state);
    else
      resolveReflections(impacts, response, state);
  };
  solve();
  if (endZenoSequence(approach, impacts)) {
    state = approach;
    for (ImpactContact& impact : impacts) impact.impulse.setZero();
    solve();
  }
  island_.log.recordFaults(island_.time, impacts, faults);
  bookImpact(impacts, island_.assembly.mechanism.bodies, approach, state);
  bookNumerical(energyConstant(island_.assembly.mechanism, approach), island_.assembly.mechanism, state);
}

/// Rebounds that are over before they are seen are left out: an accumulation of bounces ends here, as long before its
/// time as all of them would take. True if there are any.
bool EventContacts::endZenoSequence(const VectorX& approach, std::vector<ImpactContact>& impacts) {
  const VectorX& state = island_.state;
  const double accuracy = island_.scene.accuracy;
  const double lastBounce =
      std::max({kLastBounceRatio, kBounceOfAccuracy * accuracy, kBounceOfSquare * accuracy * accuracy});
  bool isEvaluated = false, found = false;
  for (ImpactContact& impact : impacts) {
    const double speed = openingSpeed(impact.contact, state), restitution = impact.material.restitution;
    const bool rebounds = openingSpeed(impact.contact, approach) < 0 && speed > 0 && restitution < 1;
    if (!rebounds || restitution == 0) continue;
    if (!isEvaluated) island_.equations.evaluate(state, derivative_);
    isEvaluated = true;
    const double closing = -openingAcceleration(impact.contact, state, derivative_);
    const double size = smallestSize(impact.contact, island_.assembly.radii);
    if (!(closing > 0) || speed > lastBounce * std::sqrt(closing * size)) continue;
    impact.restSpeed = INFINITY;
    zenoTime_ = std::max(zenoTime_, 2 * speed / (closing * (1 - restitution)));
    found = true;
  }
  return found;
}

/// Bodies that an impact has set in motion, and all that rests with them.
void EventContacts::wakeStruck(const Contact& contact) {
  for (const int body : {contact.bodyA, contact.bodyB})
    if (body != kFixed && island_.resting.isResting(body) && !isSlow(static_cast<std::size_t>(body)))
      island_.resting.wake(island_.time, body);
}

void EventContacts::recordRests(const std::vector<char>& restedBefore) {
  for (std::size_t body = 0; body < restedBefore.size(); ++body) {
    const bool rests = island_.equations.isResting(body);
    if (rests == static_cast<bool>(restedBefore[body])) continue;
    const double time = island_.time + (rests ? zenoTime_ : 0);
    island_.log.recordBody(time, rests ? EventKind::rest : EventKind::wake, static_cast<int>(body),
                           centerOfMass(island_.state, static_cast<Eigen::Index>(body)));
  }
}

}  // namespace cradle
