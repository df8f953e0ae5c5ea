#include "simulate/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "collision/time_of_impact.h"
#include "core/error.h"
#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/semi_implicit_euler.h"
#include "dynamics/invariants.h"
#include "impact/contact_impulse.h"
#include "impact/lasting_contact.h"
#include "impact/pairwise.h"

namespace cradle {
namespace {

constexpr double kDefaultTimeStep = 1.0 / 960;  // s: 16 steps a frame at 60 frames a second
constexpr double kTouchPart = 1e-9;             // of the smallest body's size: nearer counts as touching
constexpr double kImpactPart = 1e-3;            // of the touching tolerance: how well an impact's gap is closed
constexpr int kMostCorrections = 60;            // steps tried to that end; 3 are usual
constexpr int kMostImpactsPerStep = 10000;
constexpr double kSlidingSpeed = 1e-6;  // m/s: slower counts as sticking
constexpr double kTimeRounding = 1e-9;  // of a step: remainders below it are rounding

GuardNames namesOf(const Scene& scene, const Assembly& assembly, const ChosenMethod& method) {
  GuardNames names{{}, {}, method.name, method.stabilityLimit};
  for (const int body : assembly.sceneBodies) names.bodies.push_back(scene.bodies[static_cast<std::size_t>(body)].name);
  for (const Spring& spring : scene.springs) names.springs.push_back(spring.name);
  return names;
}

double touchTolerance(const ContactGeometry& geometry) {
  double smallest = 1;
  for (const BallsCollider& balls : geometry.balls)
    if (balls.body != kFixed) smallest = std::min(smallest, balls.boundingRadius);
  return kTouchPart * smallest;
}

/// Acceleration (m/s^2, world) of a body's material point at `point`, for the rates of its velocities.
Vec3 pointAcceleration(int body, const Vec3& point, const VectorX& state, const VectorX& rate) {
  if (body == kFixed) return Vec3::Zero();
  const Vec3 arm = point - centerOfMass(state, body), spin = angularVelocity(state, body);
  return linearVelocity(rate, body) + angularVelocity(rate, body).cross(arm) + spin.cross(spin.cross(arm));
}

}  // namespace

ChosenMethod chooseMethod(const Scene& scene) {
  const MethodName name = scene.method ? scene.method->name : MethodName::semiImplicitEuler;
  const double timeStep = scene.method ? scene.method->timeStep.value_or(kDefaultTimeStep) : kDefaultTimeStep;
  if (name == MethodName::explicitEuler) return {explicitEuler, "explicit Euler", timeStep, 0};
  if (name == MethodName::rk4) return {rk4, "RK4", timeStep, 2 * std::sqrt(2.0)};
  CRADLE_CHECK(name == MethodName::semiImplicitEuler);
  return {semiImplicitEuler, "semi-implicit Euler", timeStep, 2};
}

Simulation::Simulation(const Scene& scene, Assembly assembly)
    : assembly_(std::move(assembly)),
      method_(chooseMethod(scene)),
      equations_(assembly_.mechanism),
      rightHandSide_(equations_.rightHandSide()),
      resting_(assembly_.mechanism, assembly_.geometry, equations_),
      guard_(assembly_.mechanism, assembly_.state, namesOf(scene, assembly_, method_)),
      touchTolerance_(touchTolerance(assembly_.geometry)),
      duration_(scene.duration),
      state_(assembly_.state) {
  resolveContacts(state_);
}

void Simulation::advance() {
  double stepEnd = static_cast<double>(stepNumber_ + 1) * method_.timeStep;
  if (stepEnd > duration_ - kTimeRounding * method_.timeStep) stepEnd = duration_;

  // How far do bodies move freely?
  integrate(stepEnd);
  const bool atImpact = stopAtFirstImpact();
  time_ = atImpact ? step_.time + step_.timeStep : stepEnd;

  // Then take out what the step left wrong: lengths of rods, closing and overlapping contacts.
  const VectorX before = std::exchange(state_, step_.state);
  normalizeOrientations(state_);
  projectOntoRods(assembly_.mechanism.rods, assembly_.mechanism.bodies, solver_, state_);
  resolveContacts(before);
  guard_.check(state_, time_, method_.timeStep);

  if (atImpact && ++impactsInStep_ > kMostImpactsPerStep)
    throw Error(
        ErrorKind::limit, "",
        fmt::format("more than {} impacts in one step of {:.3g} s at {:.6g} s; lower a restitution of 1 between "
                    "bodies that cannot separate, or take a smaller \"timeStep\"",
                    kMostImpactsPerStep, method_.timeStep, time_));
  if (atImpact) return;
  ++stepNumber_;
  impactsInStep_ = 0;
}

void Simulation::integrate(double stepEnd) {
  method_.integrate(rightHandSide_, state_, time_, stepEnd - time_, step_);
}

/// Cuts the step at the first impact in it. The state there is a step of its own, never the interpolant, whose error
/// would let bodies overlap.
bool Simulation::stopAtFirstImpact() {
  if (assembly_.geometry.pairs.empty()) return false;
  prepareInterpolant(rightHandSide_, step_);
  const auto impact = firstImpact(assembly_.geometry, step_, touchTolerance_);
  if (!impact) return false;
  shortenStepTo(*impact);
  return true;
}

/// Finds the length of step whose end has no gap, from the interpolant's guess: the Illinois variant of regula falsi
/// (M. Dowell, P. Jarratt, 1971), which keeps the instant between a gap and an overlap.
void Simulation::shortenStepTo(const ImpactTime& impact) {
  const double whole = step_.timeStep;
  const auto gapAfter = [&](double length) {
    integrate(time_ + length);
    return contactOf(assembly_.geometry, impact.pair, impact.feature, step_.state).separation;
  };
  double apart = 0, gapApart = contactOf(assembly_.geometry, impact.pair, impact.feature, state_).separation;
  double over = impact.fraction * whole, gapOver = gapAfter(over);
  while (gapOver > 0 && over < whole) {  // the method is later than its interpolant
    apart = over, gapApart = gapOver;
    over = std::min(whole, 2 * over), gapOver = gapAfter(over);
  }
  double weightApart = gapApart, weightOver = gapOver;
  for (int i = 0; i < kMostCorrections && gapOver < -kImpactPart * touchTolerance_; ++i) {
    const double length = over + (apart - over) * weightOver / (weightOver - weightApart);
    const double gap = gapAfter(length);
    if (std::abs(gap) <= kImpactPart * touchTolerance_) return;
    if (gap > 0) {
      apart = length, weightApart = gap, weightOver /= 2;
    } else {
      over = length, gapOver = weightOver = gap, weightApart /= 2;
    }
  }
  integrate(time_ + over);
}

void Simulation::resolveContacts(const VectorX& before) {
  if (assembly_.geometry.pairs.empty()) return;
  findTouching();
  if (touching_.empty()) return;
  wakeTouched();
  const bool impacted = resolveImpacts();
  holdLasting(before);
  resolveOverlaps(assembly_.geometry, touching_, assembly_.mechanism.bodies, state_);
  if (impacted) projectVelocitiesOntoRods(assembly_.mechanism.rods, assembly_.mechanism.bodies, solver_, state_);
  for (const int body : resting_.settle(touching_, state_)) record(EventKind::rest, body);
}

/// Contacts of this instant in which something moves.
void Simulation::findTouching() {
  findContacts(assembly_.geometry, state_, touchTolerance_, touching_);
  std::erase_if(touching_, [this](const Contact& contact) {
    const bool aLies = contact.bodyA == kFixed || resting_.isResting(contact.bodyA);
    const bool bLies = contact.bodyB == kFixed || resting_.isResting(contact.bodyB);
    return aLies && bLies;
  });
}

void Simulation::wakeTouched() {
  bool woken = false;
  for (const Contact& contact : touching_)
    for (const int body : {contact.bodyA, contact.bodyB})
      for (const int other : resting_.wake(body)) {
        record(EventKind::wake, other);
        woken = true;
      }
  if (woken) findTouching();
}

/// Restitution: every contact that closes faster than one step's acceleration explains is an impact, and then all that
/// touch take part.
bool Simulation::resolveImpacts() {
  equations_.evaluate(state_, rate_);
  std::vector<ImpactContact> impacts;
  bool anyImpact = false;
  for (const Contact& contact : touching_) {
    impacts.push_back({contact, assembly_.geometry.pairs[contact.pair].law, restSpeed(contact, rate_), 0});
    anyImpact = anyImpact || -contact.normal.dot(relativeVelocity(contact, state_)) > impacts.back().restSpeed;
  }
  if (!anyImpact) return false;
  const double before = kineticEnergy(assembly_.mechanism.bodies, state_);
  resolvePairwise(impacts, assembly_.mechanism.bodies, state_);
  dissipatedEnergy(state_) += before - kineticEnergy(assembly_.mechanism.bodies, state_);
  for (const ImpactContact& impact : impacts)
    if (impact.impulse > 0) record(impact.contact, impact.impulse);
  return true;
}

/// A rebound slower than this would end within two steps: it is not resolved. Half of it is what one step adds to a
/// contact that lasts.
double Simulation::restSpeed(const Contact& contact, const VectorX& rate) const {
  const Vec3 acceleration = pointAcceleration(contact.bodyB, contact.point, state_, rate) -
                            pointAcceleration(contact.bodyA, contact.point, state_, rate);
  const double closing = std::max(0.0, -contact.normal.dot(acceleration));
  return 2 * closing * method_.timeStep + 1e-12;
}

void Simulation::holdLasting(const VectorX& before) {
  std::vector<LastingContact> lasting;
  for (const Contact& contact : touching_) {
    const SurfaceLaw& law = assembly_.geometry.pairs[contact.pair].law;
    const Vec3 velocity = relativeVelocity(contact, before);
    const double sliding = (velocity - contact.normal.dot(velocity) * contact.normal).norm();
    lasting.push_back({contact, sliding > kSlidingSpeed ? law.dynamicFriction : law.staticFriction, Vec3::Zero()});
  }
  solveLastingContacts(lasting, assembly_.mechanism.bodies, state_);
  // An impulse spread over a step does work with the mean of the velocities at the step's two ends.
  for (const LastingContact& contact : lasting)
    dissipatedEnergy(state_) -=
        contact.impulse.dot(relativeVelocity(contact.contact, before) + relativeVelocity(contact.contact, state_)) / 2;
}

VectorX Simulation::stateWithin(double time) {
  prepareInterpolant(rightHandSide_, step_);
  VectorX state;
  interpolate(step_, (time - step_.time) / step_.timeStep, state);
  normalizeOrientations(state);
  return state;
}

EnergyBalance Simulation::energyOf(const VectorX& state) const {
  const Invariants sums = invariantsOf(assembly_.mechanism, state);
  return {sums.kinetic, sums.potential, dissipatedEnergy(state), pushWork(state), sums.momentum, sums.angularMomentum};
}

std::vector<Event> Simulation::takeEvents() {
  return std::exchange(events_, {});
}

void Simulation::record(EventKind kind, int movingBody) {
  Event event;
  event.time = time_;
  event.kind = kind;
  event.bodyA = assembly_.sceneBodies[static_cast<std::size_t>(movingBody)];
  event.point = centerOfMass(state_, movingBody);
  events_.push_back(event);
}

void Simulation::record(const Contact& contact, double impulse) {
  const auto [a, b] = assembly_.pairBodies[contact.pair];
  events_.push_back({time_, EventKind::impact, a, b, contact.point, contact.normal, impulse});
}

}  // namespace cradle
