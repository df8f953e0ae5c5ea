#include "simulate/soft_substeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "constraints/invariants.h"
#include "core/error.h"
#include "core/interruption.h"
#include "math/elementary.h"
#include "simulate/contact_wrenches.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kGainRounding = 1e-9;  // of the energy that there is
// For what contacts of bodies asleep carry. All together balance the weights to some hundredths; while more than a few
// bodies move it is found in fewer sub-steps, and kept where it changes by less than kSameLoad.
constexpr int kSubStepsAtRest = 64, kSubStepsWhileSettling = 8;
constexpr double kFewAwake = 0.05;  // of all bodies
constexpr double kSameLoad = 0.05;
constexpr std::size_t kBodiesAThread = 2000;  // with fewer, threads wait for each other longer than they work

// Of the mass of all others: of driven bodies, which contacts change by as little. What contacts did to them is read
// from their velocities, to 1e-16 of these.
constexpr double kDrivenMass = 1e6;
// Of the inner radius of a body: heaps of 1000 that are shaken by 6 g go 0.05 of it deep. [0.1, 0.9]
constexpr double kPressed = 0.5;

/// Bodies that forces move, and in place of driven ones heavy balls.
std::vector<RigidBody> withHeavyDriven(const Assembly& assembly) {
  std::vector<RigidBody> bodies = assembly.mechanism.bodies;
  double mass = 0;
  for (const RigidBody& body : bodies) mass += body.mass;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].isDriven()) continue;
    const double heavy = kDrivenMass * mass, radius = assembly.radii[i] > 0 ? assembly.radii[i] : 1;
    bodies[i] = makeRigidBody({heavy, Vec3::Zero(), heavy * radius * radius * Mat3::Identity()});
  }
  return bodies;
}

int threadsFor(std::size_t bodies) {
  const std::size_t useful = std::max<std::size_t>(1, bodies / kBodiesAThread);
  return std::min(hardwareThreads(), static_cast<int>(useful));
}

}  // namespace

SoftSubsteps::SoftSubsteps(Assembly assembly, double longestStep, std::optional<int> threads)
    : assembly_(std::move(assembly)),
      state_(assembly_.state),
      bodies_(withHeavyDriven(assembly_)),
      step_(bodies_, assembly_.geometry, assembly_.mechanism.gravity,
            threads.value_or(threadsFor(assembly_.mechanism.bodies.size()))),
      longestStep_(step_.scale().time * longestStep),
      startEnergy_(energyConstant(assembly_.mechanism, state_)) {
  normalizeOrientations(state_);
  innerRadii_.assign(bodies_.size(), std::numeric_limits<double>::infinity());
  for (const Collider& collider : assembly_.geometry.colliders)
    if (collider.body != kFixed) innerRadii_[static_cast<std::size_t>(collider.body)] = innerRadius(collider);
}

SoftSubsteps::SoftSubsteps(Assembly assembly, double longestStep, const Record& record)
    : SoftSubsteps(std::move(assembly), longestStep) {
  time_ = record.time, state_ = record.state, startEnergy_ = record.startEnergy;
  hasSleepChanged_ = record.hasSleepChanged, atRest_ = record.atRest;
  step_.goOnFrom(record.step, state_);
}

const VectorX& SoftSubsteps::stateAt(double time) {
  const double same = sameTime(time);
  if (time <= time_ + same) return state_;
  const int steps = std::max(1, static_cast<int>(std::ceil((time - time_) / longestStep_ - same)));
  const double timeStep = (time - time_) / steps;
  for (int i = 0; i < steps; ++i) takeStep(timeStep);
  time_ = time;
  return state_;
}

void SoftSubsteps::takeStep(double timeStep) {
  throwIfInterrupted();
  const double constant = energyConstant(assembly_.mechanism, state_);
  const bool isLed = !assembly_.mechanism.driven.empty();
  if (isLed) lead(timeStep);
  time_ += timeStep;
  if (step_.allAsleep() && !isLed) return;
  step_.advance(timeStep, state_);
  if (isLed) requireRoom(), place();
  book(constant);
  requireNoGain();
  addEvents();
  hasSleepChanged_ = hasSleepChanged_ || !step_.fallenAsleep().empty() || !step_.woken().empty();
}

/// Gives driven bodies the velocities that lead them through a step.
void SoftSubsteps::lead(double timeStep) {
  for (const DrivenBody& driven : assembly_.mechanism.driven) {
    const PoseMotion now = motionAt(driven.motion, time_), next = motionAt(driven.motion, time_ + timeStep);
    linearVelocity(state_, driven.body) = (next.pose.translation - now.pose.translation) / timeStep;
    const Quat turn = next.pose.rotation * now.pose.rotation.conjugate();
    const Vec3 sine = (turn.w() < 0 ? -1 : 1) * turn.vec();
    const double angle = 2 * atan2(sine.norm(), std::abs(turn.w()));
    angularVelocity(state_, driven.body) = angle / timeStep * sine.stableNormalized();
  }
  led_ = state_;
}

/// Books the work of what drives bodies, against the impulses that contacts gave these, and places them where they are.
void SoftSubsteps::place() {
  for (const DrivenBody& driven : assembly_.mechanism.driven) {
    const RigidBody& body = bodies_[static_cast<std::size_t>(driven.body)];
    const Vec3 velocity = linearVelocity(led_, driven.body), spin = angularVelocity(led_, driven.body);
    const Vec3 impulse = body.mass * (linearVelocity(state_, driven.body) - velocity);
    const Vec3 angularImpulse = body.inertiaTensor * (angularVelocity(state_, driven.body) - spin);
    pushWork(state_) -= impulse.dot(velocity) + angularImpulse.dot(spin);
  }
  cradle::place(assembly_.mechanism.driven, time_, state_);
}

/// Ends the run where driven bodies press others into something: soft contacts would let them through.
void SoftSubsteps::requireRoom() const {
  const auto isDriven = [this](int body) {
    return assembly_.mechanism.bodies[static_cast<std::size_t>(body)].isDriven();
  };
  const auto nameOf = [this](int body) { return assembly_.names.bodies[static_cast<std::size_t>(body)]; };
  for (const ManifoldLink& link : step_.contacts().active()) {
    if (link.bodyB == kFixed || isDriven(link.bodyA) == isDriven(link.bodyB)) continue;
    const PersistentManifold& manifold = step_.contacts().manifolds()[static_cast<std::size_t>(link.manifold)];
    const int pressed = isDriven(link.bodyA) ? link.bodyB : link.bodyA;
    const double most = kPressed * innerRadii_[static_cast<std::size_t>(pressed)];
    for (std::int32_t i = 0; i < manifold.count; ++i)
      if (manifold.separations[static_cast<std::size_t>(i)] < -most)
        throw Error(ErrorKind::unstable, "",
                    fmt::format("unstable at {:.6g} s: \"{}\" is pressed into \"{}\": what is driven leaves no room; "
                                "keep it farther off, or let a spring press in its place",
                                time_, nameOf(pressed), nameOf(pressed == link.bodyA ? link.bodyB : link.bodyA)));
  }
}

/// What contacts would give of energy, in all, is an error and none of theirs; so is what overlaps and their removal do
/// to the potential energy, and what bodies have when they fall asleep.
void SoftSubsteps::book(double constant) {
  impactEnergy(state_) += std::max(0.0, step_.taken().byImpact);
  frictionEnergy(state_) += std::max(0.0, step_.taken().byFriction);
  bookNumerical(constant, assembly_.mechanism, state_);
}

/// Whatever errors do, there is never more energy than at the start.
void SoftSubsteps::requireNoGain() const {
  const Invariants now = invariantsOf(assembly_.mechanism, state_);
  const double lost = startEnergy_ + pushWork(state_) - (now.kinetic + now.potential);
  const double rounding = kGainRounding * (std::abs(startEnergy_) + std::abs(now.potential) + now.kinetic);
  if (!state_.allFinite() || !(lost >= -rounding))
    throw Error(ErrorKind::unstable, "",
                fmt::format("unstable at {:.6g} s: a pile of {} bodies from \"{}\" on has {:.3g} J more energy than at "
                            "the start; give the scene an \"accuracy\" of 1e-4 or finer",
                            time_, assembly_.names.bodies.size(), assembly_.names.bodies[0], -lost));
}

void SoftSubsteps::addEvents() {
  const auto addBody = [&](EventKind kind, int body) {
    events_.push_back({time_, kind, assembly_.sceneBodies[static_cast<std::size_t>(body)], kWorld,
                       Vec3(centerOfMass(state_, body)), Vec3::Zero(), 0});
  };
  for (const SoftStep::Impact& impact : step_.impacts()) {
    const auto [a, b] = bodiesOf(assembly_, impact.pair);
    events_.push_back({time_, EventKind::impact, a, b, impact.point, impact.normal, impact.impulse});
  }
  for (const int body : step_.woken()) addBody(EventKind::wake, body);
  for (const int body : step_.fallenAsleep())
    if (!assembly_.mechanism.bodies[static_cast<std::size_t>(body)].isDriven()) addBody(EventKind::rest, body);
}

bool SoftSubsteps::isAwake(int sceneBody) const {
  const int body = indexAmong(assembly_.sceneBodies, sceneBody);
  return body != kFixed && !step_.isAsleep(static_cast<std::size_t>(body));
}

std::vector<ContactWrench> SoftSubsteps::contactWrenches() {
  if (std::exchange(hasSleepChanged_, false)) findLoadsAtRest();
  const std::vector<SoftContactSolver::MeanLoad> loads = step_.meanLoads();
  std::vector<std::pair<int, int>> met;  // scene bodies
  for (const SoftStep::Impact& impact : step_.impacts()) met.push_back(bodiesOf(assembly_, impact.pair));
  std::ranges::sort(met);
  WrenchSum sum;
  step_.contacts().forEachContact([&](const ColliderPair& pair, std::int32_t index, bool isExchanged) {
    if (!isStill(pair) && !std::ranges::binary_search(met, bodiesOf(assembly_, pair)))
      addLoad({pair, index, isExchanged}, loads, sum);
  });
  std::vector<ContactWrench> wrenches = sum.wrenches();
  for (const auto& [bodies, wrench] : atRest_) wrenches.push_back(wrench);
  return wrenches;
}

void SoftSubsteps::findLoadsAtRest() {
  const bool isSettled = static_cast<double>(step_.awake()) <= kFewAwake * static_cast<double>(bodies_.size());
  const auto loads = step_.loadsAtRest(isSettled ? kSubStepsAtRest : kSubStepsWhileSettling);
  WrenchSum sum;
  step_.contacts().forEachContact([&](const ColliderPair& pair, std::int32_t index, bool isExchanged) {
    if (isStill(pair)) addLoad({pair, index, isExchanged}, loads, sum);
  });
  std::map<std::pair<int, int>, ContactWrench> atRest;
  for (const ContactWrench& wrench : sum.wrenches()) {
    const std::pair bodies{wrench.bodyA, wrench.bodyB};
    const auto before = atRest_.find(bodies);
    const bool isSame = before != atRest_.end() && !isSettled &&
                        (wrench.force - before->second.force).norm() < kSameLoad * wrench.force.norm();
    atRest.emplace_hint(atRest.end(), bodies, isSame ? before->second : wrench);
  }
  atRest_ = std::move(atRest);
}

bool SoftSubsteps::isStill(const ColliderPair& pair) const {
  const auto bodies = bodiesOf(assembly_, pair);
  return !isAwake(bodies.first) && !isAwake(bodies.second);
}

void SoftSubsteps::addLoad(const SoftContacts::Meeting& contact, const std::vector<SoftContactSolver::MeanLoad>& loads,
                           WrenchSum& sum) const {
  const auto index = static_cast<std::size_t>(contact.manifold);
  const SoftContactSolver::MeanLoad& load = loads[index];
  const PersistentManifold& manifold = step_.contacts().manifolds()[index];
  if (!(std::accumulate(load.forces.begin(), load.forces.begin() + load.points, 0.0) > 0)) return;
  const auto [a, b] = bodiesOf(assembly_, contact.pair);
  const Vec3 center = centerOfMass(state_, manifold.bodyA);
  const Mat3 worldFromA = orientation(state_, manifold.bodyA).toRotationMatrix();
  const double sign = contact.isExchanged ? -1 : 1;
  const Vec3 normal = sign * manifold.normal;
  Vec3 middle = Vec3::Zero();
  for (int i = 0; i < load.points; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Vec3 point = center + worldFromA * manifold.onA[at].cast<double>();
    middle += point / load.points;
    sum.add({a, b, point, load.forces[at], load.forces[at] * normal, Vec3::Zero()});
  }
  sum.add({a, b, middle, 0, Vec3::Zero(), sign * load.frictionForce, load.twist * normal});
}

std::vector<Event> SoftSubsteps::takeEvents() {
  return std::exchange(events_, {});
}

}  // namespace cradle
