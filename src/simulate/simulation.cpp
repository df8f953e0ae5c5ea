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

namespace cradle {
namespace {

constexpr double kDefaultTimeStep = 1.0 / 960;  // s: 16 steps a frame at 60 frames a second
constexpr double kImpactPart = 1e-3;            // of the touching tolerance: how well an impact's gap is closed
constexpr int kMostCorrections = 60;            // steps tried to that end; 3 are usual
constexpr int kMostEventsPerStep = 10000;
constexpr double kRopeTolerance = 1e-13;  // m of slack, or part of the tension that is left
constexpr double kTimeRounding = 1e-9;    // of a step: remainders below it are rounding

GuardNames namesOf(const Scene& scene, const Assembly& assembly, const ChosenMethod& method) {
  GuardNames names{{}, {}, method.name, method.stabilityLimit};
  for (const int body : assembly.sceneBodies) names.bodies.push_back(scene.bodies[static_cast<std::size_t>(body)].name);
  for (const Spring& spring : scene.springs) names.springs.push_back(spring.name);
  return names;
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
    : scene_(scene),
      assembly_(std::move(assembly)),
      method_(chooseMethod(scene)),
      equations_(assembly_.mechanism),
      rightHandSide_(equations_.rightHandSide()),
      log_(assembly_),
      contacts_(assembly_, equations_, log_, method_.timeStep),
      ropes_(assembly_, equations_, contacts_, log_, method_.timeStep),
      pushes_(scene, assembly_.movingBodies, log_),
      guard_(assembly_.mechanism, assembly_.state, namesOf(scene, assembly_, method_)),
      solver_(assembly_.mechanism.constraints, assembly_.mechanism.bodies),
      duration_(scene.duration),
      state_(assembly_.state) {
  contacts_.resolve(time_, state_, state_);
  ropes_.resolve(time_, state_);
  beginAndEndPushes();
  requireUnsolvedPairsApart();
}

void Simulation::advance() {
  double gridEnd = static_cast<double>(stepNumber_ + 1) * method_.timeStep;
  if (gridEnd > duration_ - kTimeRounding * method_.timeStep) gridEnd = duration_;
  const double stepEnd = std::min(gridEnd, pushes_.nextChange());

  // How far do bodies move freely?
  integrate(stepEnd);
  const bool atEvent = stopAtFirstEvent();
  time_ = atEvent ? step_.time + step_.timeStep : stepEnd;

  // Take out what the step left wrong: lengths of rods, closing and overlapping contacts. Then what changes here?
  const VectorX before = std::exchange(state_, step_.state);
  normalizeOrientations(state_);
  if (solver_.hasConstraints()) solver_.project(state_);
  contacts_.resolve(time_, before, state_);
  ropes_.resolve(time_, state_);
  beginAndEndPushes();
  guard_.check(state_, time_, method_.timeStep);
  requireUnsolvedPairsApart();

  if (atEvent) countEvent();
  if (time_ < gridEnd) return;
  ++stepNumber_;
  eventsInStep_ = 0;
}

void Simulation::integrate(double stepEnd) {
  method_.integrate(rightHandSide_, state_, time_, stepEnd - time_, step_);
}

/// Cuts the step at the first event in it. The state there is a step of its own, never the interpolant, whose error
/// would let bodies overlap.
bool Simulation::stopAtFirstEvent() {
  if (assembly_.geometry.pairs.empty() && !ropes_.hasRopes()) return false;
  prepareInterpolant(rightHandSide_, step_);
  const auto impact = firstImpact(assembly_.geometry, step_, contacts_.touchTolerance());
  const auto change = ropes_.firstChange(step_);
  const double whole = step_.timeStep;
  if (impact && !(change && change->fraction < impact->fraction)) {
    shortenStepTo(impact->fraction * whole, kImpactPart * contacts_.touchTolerance(), [&](const VectorX& state) {
      return separation(assembly_.geometry, assembly_.geometry.pairs[impact->pair], impact->feature, state);
    });
  } else if (change) {
    shortenStepTo(change->fraction * whole, kRopeTolerance,
                  [&](const VectorX& state) { return ropes_.margin(*change, state); });
  }
  return impact || change;
}

/// Finds the length of step whose end is at the event, from the interpolant's guess: `margin` > 0 before the event, and
/// left between 0 and `tolerance` of it. The Illinois variant of regula falsi (M. Dowell, P. Jarratt, 1971).
void Simulation::shortenStepTo(double length, double tolerance, const std::function<double(const VectorX&)>& margin) {
  const double whole = step_.timeStep;
  const auto marginAfter = [&](double part) {
    integrate(time_ + part);
    return margin(step_.state);
  };
  double early = 0, earlyMargin = margin(state_);
  double late = length, lateMargin = marginAfter(late);
  while (lateMargin > 0 && late < whole) {  // the method is later than its interpolant
    early = late, earlyMargin = lateMargin;
    late = std::min(whole, 2 * late), lateMargin = marginAfter(late);
  }
  double earlyWeight = earlyMargin, lateWeight = lateMargin;
  for (int i = 0; i < kMostCorrections && lateMargin < -tolerance; ++i) {
    const double part = late + (early - late) * lateWeight / (lateWeight - earlyWeight);
    const double found = marginAfter(part);
    if (std::abs(found) <= tolerance) return;
    if (found > 0) {
      early = part, earlyWeight = found, lateWeight /= 2;
    } else {
      late = part, lateMargin = lateWeight = found, earlyWeight /= 2;
    }
  }
  integrate(time_ + late);
}

void Simulation::beginAndEndPushes() {
  if (time_ < pushes_.nextChange()) return;
  for (const int body : pushes_.apply(time_, state_, assembly_.mechanism.pushes)) contacts_.wake(time_, body, state_);
}

/// Contact that cannot be computed must not come about: passing through each other silently would be a lie.
void Simulation::requireUnsolvedPairsApart() const {
  for (const ColliderPair& pair : assembly_.geometry.unsolvedPairs) {
    const int a = assembly_.geometry.colliders[pair.a].body, b = bodyBOf(assembly_.geometry, pair);
    if (separationBound(assembly_.geometry, pair, poseOf(state_, a), poseOf(state_, b)) > 0) continue;
    const auto nameOf = [this](int body) {
      const auto sceneBody = static_cast<std::size_t>(assembly_.sceneBodies[static_cast<std::size_t>(body)]);
      return scene_.bodies[sceneBody].name;
    };
    throw Error(ErrorKind::scene, scene_.path,
                fmt::format("\"{}\" and \"{}\" come within reach of each other at {:.6g} s; their contact cannot be "
                            "simulated yet: keep them apart, or give one of them \"collision\": \"none\"",
                            nameOf(a), nameOf(b), time_));
  }
}

void Simulation::countEvent() {
  if (++eventsInStep_ <= kMostEventsPerStep) return;
  throw Error(ErrorKind::limit, "",
              fmt::format("more than {} impacts in one step of {:.3g} s at {:.6g} s; lower a restitution of 1 between "
                          "bodies that cannot separate, or take a smaller \"timeStep\"",
                          kMostEventsPerStep, method_.timeStep, time_));
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

}  // namespace cradle
