#include "simulate/contact_stage.h"

#include <algorithm>
#include <cmath>

#include "dynamics/invariants.h"
#include "impact/contact_impulse.h"
#include "impact/lasting_contact.h"
#include "impact/pairwise.h"

namespace cradle {
namespace {

constexpr double kTouchPart = 1e-9;        // of the smallest body's size: nearer counts as touching
constexpr double kSlidingSpeed = 1e-6;     // m/s: slower counts as sticking
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
      resting_(assembly.mechanism, assembly.geometry, equations),
      timeStep_(timeStep),
      touchTolerance_(cradle::touchTolerance(assembly.geometry)) {}

void ContactStage::wake(double time, int body, const VectorX& state) {
  for (const int other : resting_.wake(body)) log_.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
}

void ContactStage::resolve(double time, const VectorX& before, VectorX& state) {
  if (assembly_.geometry.pairs.empty()) return;
  findTouching(state);
  if (touching_.empty()) return;
  wakeTouched(time, state);
  resolveImpacts(time, state);
  holdLasting(before, state);
  resolveOverlaps(assembly_.geometry, touching_, assembly_.mechanism.bodies, state);
  for (const int body : resting_.settle(touching_, state))
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
      for (const int other : resting_.wake(body)) {
        log_.recordBody(time, EventKind::wake, other, centerOfMass(state, other));
        woken = true;
      }
  if (woken) findTouching(state);
}

/// Restitution: every contact that closes faster than one step's acceleration explains is an impact, and then all that
/// touch take part.
void ContactStage::resolveImpacts(double time, VectorX& state) {
  equations_.evaluate(state, rate_);
  std::vector<ImpactContact> impacts;
  bool anyImpact = false;
  for (const Contact& contact : touching_) {
    impacts.push_back({contact, assembly_.geometry.pairs[contact.pair].law, restSpeed(contact, state), 0});
    anyImpact = anyImpact || -contact.normal.dot(relativeVelocity(contact, state)) > impacts.back().restSpeed;
  }
  if (!anyImpact) return;
  const double before = kineticEnergy(assembly_.mechanism.bodies, state);
  resolvePairwise(impacts, assembly_.mechanism.bodies, state);
  projectVelocitiesOntoRods(assembly_.mechanism.rods, assembly_.mechanism.bodies, solver_, state);
  dissipatedEnergy(state) += before - kineticEnergy(assembly_.mechanism.bodies, state);
  for (const ImpactContact& impact : impacts)
    if (impact.impulse > 0) log_.recordContact(time, EventKind::impact, impact.contact, impact.impulse);
}

/// A rebound slower than this would end within about two steps: it is not resolved. What one step adds to the closing
/// of a contact that lasts is at most half of it. Bodies in free fall side by side have no such speed: their impacts
/// are resolved however slow.
double ContactStage::restSpeed(const Contact& contact, const VectorX& state) const {
  const Vec3 acceleration = pointAcceleration(contact.bodyB, contact.point, state, rate_) -
                            pointAcceleration(contact.bodyA, contact.point, state, rate_);
  return 2 * acceleration.norm() * timeStep_ + kRestSpeedFloor;
}

void ContactStage::holdLasting(const VectorX& before, VectorX& state) {
  std::vector<LastingContact> lasting;
  for (const Contact& contact : touching_) {
    const SurfaceLaw& law = assembly_.geometry.pairs[contact.pair].law;
    const Vec3 velocity = relativeVelocity(contact, before);
    const double sliding = (velocity - contact.normal.dot(velocity) * contact.normal).norm();
    lasting.push_back({contact, sliding > kSlidingSpeed ? law.dynamicFriction : law.staticFriction, Vec3::Zero()});
  }
  solveLastingContacts(lasting, assembly_.mechanism.bodies, state);
  // An impulse spread over a step does work with the mean of the velocities at the step's two ends.
  for (const LastingContact& contact : lasting)
    dissipatedEnergy(state) -=
        contact.impulse.dot(relativeVelocity(contact.contact, before) + relativeVelocity(contact.contact, state)) / 2;
}

}  // namespace cradle
