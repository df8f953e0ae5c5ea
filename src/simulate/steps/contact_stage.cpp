#include "simulate/steps/contact_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dynamics/invariants.h"
#include "impact/contact_impulse.h"
#include "impact/frictional_impact.h"
#include "impact/generalized_reflections.h"
#include "impact/lasting_contact.h"
#include "simulate/steps/contact_energy.h"

namespace cradle {
namespace {

constexpr double kTouchPart = 1e-9;        // of the smallest body's size: nearer counts as touching
constexpr double kSlidingSpeed = 1e-6;     // m/s: slower counts as sticking
constexpr long kFewLoaded = 8;             // contacts that last: more are resolved step by step
constexpr double kReach = 2;               // of the way that a body goes freely: what others may make of it
constexpr double kReachPart = 1e-3;        // of its size: the same, for bodies at rest
constexpr double kCalmSteps = 20;          // awake at least so long: a rattle is no row of rests
constexpr double kRestSteps = 2;           // a rebound that ends within as many steps is not resolved
constexpr double kRestSpeedFloor = 1e-12;  // m/s: rounding
constexpr double kLeastImpactPart = 0.01;  // of the speed that gravity gives in a step: slower is no impact

double touchTolerance(const ContactGeometry& geometry) {
  double smallest = 1;
  for (const Collider& balls : geometry.colliders)
    if (balls.body != kFixed) smallest = std::min(smallest, balls.boundingRadius);
  return kTouchPart * smallest;
}

double closingSpeed(const Contact& contact, const VectorX& state) {
  return -contact.normal.dot(relativeVelocity(contact, state));
}

/// Without friction by reflections; with it by the same on Coulomb's cones.
void resolveImpact(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state) {
  const bool hasFriction = std::any_of(impacts.begin(), impacts.end(), [](const ImpactContact& impact) {
    return impact.law.staticFriction > 0 || impact.law.dynamicFriction > 0;
  });
  hasFriction ? resolveFrictionalImpact(impacts, response, state) : resolveReflections(impacts, response, state);
}

}  // namespace

ContactStage::ContactStage(MovingIsland& island, double timeStep)
    : assembly_(island.assembly),
      log_(island.log),
      resting_(island.resting),
      solver_(assembly_.mechanism.constraints, assembly_.mechanism.bodies),
      timeStep_(timeStep),
      touchTolerance_(cradle::touchTolerance(assembly_.geometry)),
      leastImpactSpeed_(kRestSpeedFloor + kLeastImpactPart * assembly_.mechanism.gravity.norm() * timeStep),
      stepping_(assembly_) {
  resting_.setCalmTime(kCalmSteps * timeStep);
}

void ContactStage::resolve(double time, const VectorX& before, VectorX& state) {
  stepPart_ = (time - std::exchange(lastTime_, time)) / timeStep_;
  if (assembly_.geometry.colliders.empty()) return;
  findTouching(state, touchTolerance_);
  if (touching_.empty()) return;
  wakeTouched(time, state);
  if (solver_.hasConstraints()) solver_.factorize(state);
  const std::vector<int> bodies = touchingBodies();
  const double most = energyOf(bodies, assembly_.mechanism, state), dissipated = dissipatedEnergy(state);
  resolveImpacts(time, before, state);
  holdLasting(before, state);
  resolveOverlaps(assembly_.geometry, touching_, ImpulseResponse(assembly_.mechanism.bodies, solver_), state);
  if (isGain(energyOf(bodies, assembly_.mechanism, state), most)) {
    limitEnergy(bodies, most, assembly_.mechanism, state);
    dissipatedEnergy(state) = dissipated + most - energyOf(bodies, assembly_.mechanism, state);
  }
  for (const int body : resting_.settle(time, touching_, state))
    log_.recordBody(time, EventKind::rest, body, centerOfMass(state, body));
}

/// Contacts that may close within a step, also if others make the bodies faster.
void ContactStage::findWithinReach(const VectorX& before, const VectorX& state, double length) {
  std::vector<double> ways;  // m, of each body within the step
  double farthest = 0;
  for (std::size_t i = 0; i < assembly_.radii.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    double speed = 0;
    for (const VectorX* moment : {&before, &state})
      speed = std::max(
          speed, linearVelocity(*moment, body).norm() + assembly_.radii[i] * angularVelocity(*moment, body).norm());
    ways.push_back(kReach * speed * length + kReachPart * assembly_.radii[i]);
    farthest = std::max(farthest, ways.back());
  }
  findTouching(before, 2 * farthest);
  std::erase_if(touching_, [&](const Contact& contact) {
    double way = 0;
    for (const int body : {contact.bodyA, contact.bodyB})
      if (body != kFixed) way += ways[static_cast<std::size_t>(body)];
    return contact.separation > way;
  });
}

void ContactStage::resolveStep(double time, const VectorX& before, VectorX& state) {
  const double length = time - std::exchange(lastTime_, time);
  findWithinReach(before, state, length);
  // What rests is woken by what closes within the step, with all that it rests on.
  bool woken = false;
  for (const Contact& contact : touching_) {
    const double closing = -contact.normal.dot(relativeVelocity(contact, before, state));
    if (contact.separation - length * std::max(0.0, closing) > touchTolerance_) continue;
    for (const int body : {contact.bodyA, contact.bodyB})
      for (const int other : resting_.wake(time, body)) {
        log_.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
        woken = true;
      }
  }
  if (woken) findWithinReach(before, state, length);
  stepping_.resolve(touching_, before, length, state);
  std::vector<Contact> acting;
  for (const SteppedContact& stepped : stepping_.contacts()) {
    const double impulse = stepped.contact.normal.dot(stepped.impulse);
    if (impulse <= 0) continue;
    acting.push_back(stepped.contact);
    if (stepped.isImpact) log_.recordContact(time, EventKind::impact, stepped.contact, impulse);
  }
  isCrowded_ = !acting.empty();
  for (const int body : resting_.settle(time, acting, state))
    log_.recordBody(time, EventKind::rest, body, centerOfMass(state, body));
}

/// Contacts of this instant in which something moves.
void ContactStage::findTouching(const VectorX& state, double margin) {
  findContacts(assembly_.geometry, state, margin, touching_);
  std::erase_if(touching_, [this](const Contact& contact) {
    const bool aLies = contact.bodyA == kFixed || resting_.isResting(contact.bodyA);
    const bool bLies = contact.bodyB == kFixed || resting_.isResting(contact.bodyB);
    return aLies && bLies;
  });
}

/// Bodies that contacts of this instant move, with those that are tied to them.
std::vector<int> ContactStage::touchingBodies() const {
  const Islands islands = findStruckTogether();
  std::vector<char> isMoved(assembly_.mechanism.bodies.size(), 0);
  for (const Contact& contact : touching_)
    isMoved[static_cast<std::size_t>(islands.islandOf(contact.bodyA != kFixed ? contact.bodyA : contact.bodyB))] = 1;
  std::vector<int> bodies;
  for (int body = 0; body < std::ssize(isMoved); ++body)
    if (isMoved[static_cast<std::size_t>(islands.islandOf(body))]) bodies.push_back(body);
  return bodies;
}

void ContactStage::wakeTouched(double time, const VectorX& state) {
  bool woken = false;
  for (const Contact& contact : touching_)
    for (const int body : {contact.bodyA, contact.bodyB})
      for (const int other : resting_.wake(time, body)) {
        log_.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
        woken = true;
      }
  if (woken) findTouching(state, touchTolerance_);
}

/// Restitution. A contact that closes faster than acceleration explains is an impact, and then all that touch each
/// other there take part. What explains: the speed that it gained since the last step, part of a step as that may have
/// been, would have in `kRestSteps` whole ones.
void ContactStage::resolveImpacts(double time, const VectorX& before, VectorX& state) {
  for (std::vector<ImpactContact>& impacts : findImpacts(before, state)) {
    if (impacts.empty()) continue;
    const VectorX approach = state;
    resolveImpact(impacts, ImpulseResponse(assembly_.mechanism.bodies, solver_), state);
    for (const ImpactContact& impact : impacts) {
      // What a lasting contact took was an acceleration's, spread over the step.
      const bool isLasting = closingSpeed(impact.contact, approach) <= impact.restSpeed;
      dissipate(impact.contact, impact.impulse, isLasting ? before : approach, state);
      const double impulse = impact.contact.normal.dot(impact.impulse);
      if (impulse > 0) log_.recordContact(time, EventKind::impact, impact.contact, impulse);
    }
  }
}

/// What an impact at a contact moves with others: bodies that touch each other or are tied.
Islands ContactStage::findStruckTogether() const {
  Islands islands(assembly_.mechanism.bodies.size());
  for (const Contact& contact : touching_) islands.join(contact.bodyA, contact.bodyB);
  forEachTie(assembly_.mechanism.constraints, [&](int bodyA, int bodyB) { islands.join(bodyA, bodyB); });
  return islands;
}

/// The impacts of this instant by island; most are empty.
std::vector<std::vector<ImpactContact>> ContactStage::findImpacts(const VectorX& before, const VectorX& state) const {
  const Islands islands = findStruckTogether();
  std::vector<std::vector<ImpactContact>> impacts(assembly_.mechanism.bodies.size());
  std::vector<char> isStruck(impacts.size(), 0);
  for (const Contact& contact : touching_) {
    const double closing = closingSpeed(contact, state);
    const double gained = closing + contact.normal.dot(relativeVelocity(contact, state, before));
    const double restSpeed = std::max(kRestSteps * std::max(0.0, gained / stepPart_), leastImpactSpeed_);
    const int body = contact.bodyA != kFixed ? contact.bodyA : contact.bodyB;
    const auto island = static_cast<std::size_t>(islands.islandOf(body));
    impacts[island].push_back({contact, assembly_.geometry.pairs[contact.pair].law, restSpeed, Vec3::Zero()});
    if (closing > restSpeed) isStruck[island] = 1;
  }
  for (std::size_t island = 0; island < impacts.size(); ++island)
    if (!isStruck[island]) impacts[island].clear();
  return impacts;
}

/// Books what an impulse (N s, on B) took: it works with the mean of the velocities before and after it.
void ContactStage::dissipate(const Contact& contact, const Vec3& impulse, const VectorX& before, VectorX& state) {
  const Vec3 meanVelocity = (relativeVelocity(contact, state, before) + relativeVelocity(contact, state)) / 2;
  dissipatedEnergy(state) -= impulse.dot(meanVelocity);
}

void ContactStage::holdLasting(const VectorX& before, VectorX& state) {
  std::vector<LastingContact> lasting;
  for (const Contact& contact : touching_) {
    const SurfaceLaw& law = assembly_.geometry.pairs[contact.pair].law;
    const Vec3 velocity = relativeVelocity(contact, state, before);
    const double sliding = (velocity - contact.normal.dot(velocity) * contact.normal).norm();
    lasting.push_back({contact, sliding > kSlidingSpeed ? law.dynamicFriction : law.staticFriction, Vec3::Zero()});
  }
  solveLastingContacts(lasting, ImpulseResponse(assembly_.mechanism.bodies, solver_), state);
  for (const LastingContact& contact : lasting) dissipate(contact.contact, contact.impulse, before, state);
  const auto isLoaded = [](const LastingContact& contact) { return contact.impulse.dot(contact.contact.normal) > 0; };
  isCrowded_ = std::count_if(lasting.begin(), lasting.end(), isLoaded) > kFewLoaded;
}

}  // namespace cradle
