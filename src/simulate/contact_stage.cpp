#include "simulate/contact_stage.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dynamics/invariants.h"
#include "impact/contact_impulse.h"
#include "impact/lasting_contact.h"
#include "simulate/islands.h"

namespace cradle {
namespace {

constexpr double kTouchPart = 1e-9;        // of the smallest body's size: nearer counts as touching
constexpr double kSlidingSpeed = 1e-6;     // m/s: slower counts as sticking
constexpr double kCalmSteps = 20;          // awake at least so long: a rattle is no row of rests
constexpr double kRestSteps = 2;           // a rebound that ends within as many steps is not resolved
constexpr double kRestSpeedFloor = 1e-12;  // m/s: rounding

double touchTolerance(const ContactGeometry& geometry) {
  double smallest = 1;
  for (const Collider& balls : geometry.colliders)
    if (balls.body != kFixed) smallest = std::min(smallest, balls.boundingRadius);
  return kTouchPart * smallest;
}

}  // namespace

ContactStage::ContactStage(const Assembly& assembly, EquationsOfMotion& equations, EventLog& log, double timeStep)
    : assembly_(assembly),
      equations_(equations),
      log_(log),
      resting_(assembly.mechanism, assembly.geometry, equations, kCalmSteps * timeStep),
      solver_(assembly.mechanism.constraints, assembly.mechanism.bodies),
      timeStep_(timeStep),
      touchTolerance_(cradle::touchTolerance(assembly.geometry)) {}

void ContactStage::wake(double time, int body, const VectorX& state) {
  for (const int other : resting_.wake(time, body))
    log_.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
}

void ContactStage::resolve(double time, const VectorX& before, VectorX& state) {
  stepPart_ = (time - std::exchange(lastTime_, time)) / timeStep_;
  if (assembly_.geometry.pairs.empty()) return;
  findTouching(state);
  if (touching_.empty()) return;
  wakeTouched(time, state);
  if (solver_.hasConstraints()) solver_.factorize(state);
  resolveImpacts(time, before, state);
  holdLasting(before, state);
  resolveOverlaps(assembly_.geometry, touching_, ImpulseResponse(assembly_.mechanism.bodies, solver_), state);
  for (const int body : resting_.settle(time, touching_, state))
    log_.recordBody(time, EventKind::rest, body, centerOfMass(state, body));
}

/// Contacts of this instant in which something moves.
void ContactStage::findTouching(const VectorX& state) {
  findContacts(assembly_.geometry, state, touchTolerance_, touching_);
  std::erase_if(touching_, [this](const Contact& contact) {
    const bool aLies = contact.bodyA == kFixed || resting_.isResting(contact.bodyA);
    const bool bLies = contact.bodyB == kFixed || resting_.isResting(contact.bodyB);
    return aLies && bLies;
  });
}

void ContactStage::wakeTouched(double time, const VectorX& state) {
  bool woken = false;
  for (const Contact& contact : touching_)
    for (const int body : {contact.bodyA, contact.bodyB})
      for (const int other : resting_.wake(time, body)) {
        log_.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
        woken = true;
      }
  if (woken) findTouching(state);
}

/// Restitution. A contact that closes faster than acceleration explains is an impact, and then all that touch each
/// other there take part. What explains: the speed that it gained since the last step, part of a step as that may have
/// been, would have in `kRestSteps` whole ones.
void ContactStage::resolveImpacts(double time, const VectorX& before, VectorX& state) {
  std::vector<ImpactContact> impacts = findImpacts(before, state);
  if (impacts.empty()) return;
  const double energy = kineticEnergy(assembly_.mechanism.bodies, state);
  resolvePairwise(impacts, ImpulseResponse(assembly_.mechanism.bodies, solver_), state);
  dissipatedEnergy(state) += energy - kineticEnergy(assembly_.mechanism.bodies, state);
  for (const ImpactContact& impact : impacts)
    if (impact.impulse > 0) log_.recordContact(time, EventKind::impact, impact.contact, impact.impulse);
}

std::vector<ImpactContact> ContactStage::findImpacts(const VectorX& before, const VectorX& state) const {
  const std::size_t bodies = assembly_.mechanism.bodies.size();
  Islands islands(bodies);
  for (const Contact& contact : touching_) islands.join(contact.bodyA, contact.bodyB);
  const auto islandOf = [&](const Contact& contact) {
    return static_cast<std::size_t>(islands.islandOf(contact.bodyA != kFixed ? contact.bodyA : contact.bodyB));
  };

  std::vector<ImpactContact> impacts;
  std::vector<char> isStruck(bodies, 0);  // by island
  for (const Contact& contact : touching_) {
    const double closing = -contact.normal.dot(relativeVelocity(contact, state));
    const double gained = closing + contact.normal.dot(relativeVelocity(contact, state, before));
    const double restSpeed = kRestSteps * std::max(0.0, gained / stepPart_) + kRestSpeedFloor;
    impacts.push_back({contact, assembly_.geometry.pairs[contact.pair].law, restSpeed, 0});
    if (closing > restSpeed) isStruck[islandOf(contact)] = 1;
  }
  std::erase_if(impacts, [&](const ImpactContact& impact) { return !isStruck[islandOf(impact.contact)]; });
  return impacts;
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
  // An impulse spread over a step does work with the mean of the velocities at the step's two ends.
  for (const LastingContact& lastingContact : lasting) {
    const Contact& contact = lastingContact.contact;
    const Vec3 meanVelocity = (relativeVelocity(contact, state, before) + relativeVelocity(contact, state)) / 2;
    dissipatedEnergy(state) -= lastingContact.impulse.dot(meanVelocity);
  }
}

}  // namespace cradle
