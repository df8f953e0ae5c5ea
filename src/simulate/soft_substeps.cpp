#include "simulate/soft_substeps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "constraints/invariants.h"
#include "core/error.h"
#include "core/interruption.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

constexpr double kGainRounding = 1e-9;        // of the energy that there is
constexpr std::size_t kBodiesAThread = 2000;  // with fewer, threads wait for each other longer than they work

int threadsFor(std::size_t bodies) {
  const std::size_t useful = std::max<std::size_t>(1, bodies / kBodiesAThread);
  return std::min(hardwareThreads(), static_cast<int>(useful));
}

}  // namespace

SoftSubsteps::SoftSubsteps(Assembly assembly, double longestStep, std::optional<int> threads)
    : assembly_(std::move(assembly)),
      state_(assembly_.state),
      longestStep_(longestStep),
      step_(assembly_.mechanism.bodies, assembly_.geometry, assembly_.mechanism.gravity,
            threads.value_or(threadsFor(assembly_.mechanism.bodies.size()))),
      startEnergy_(energyConstant(assembly_.mechanism, state_)) {
  normalizeOrientations(state_);
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
  time_ += timeStep;
  if (step_.allAsleep()) return;
  const double constant = energyConstant(assembly_.mechanism, state_);
  step_.advance(timeStep, state_);
  book(constant);
  requireNoGain();
  record();
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
  const double lost = startEnergy_ - (now.kinetic + now.potential);
  const double rounding = kGainRounding * (std::abs(startEnergy_) + std::abs(now.potential) + now.kinetic);
  if (!state_.allFinite() || !(lost >= -rounding))
    throw Error(ErrorKind::unstable, "",
                fmt::format("unstable at {:.6g} s: a pile of {} bodies from \"{}\" on has {:.3g} J more energy than at "
                            "the start; give the scene an \"accuracy\" of 1e-4 or finer",
                            time_, assembly_.names.bodies.size(), assembly_.names.bodies[0], -lost));
}

void SoftSubsteps::record() {
  const auto recordBody = [&](EventKind kind, int body) {
    events_.push_back({time_, kind, assembly_.sceneBodies[static_cast<std::size_t>(body)], kWorld,
                       Vec3(centerOfMass(state_, body)), Vec3::Zero(), 0});
  };
  for (const SoftStep::Impact& impact : step_.impacts()) {
    const auto [a, b] = bodiesOf(assembly_, impact.pair);
    events_.push_back({time_, EventKind::impact, a, b, impact.point, impact.normal, impact.impulse});
  }
  for (const int body : step_.woken()) recordBody(EventKind::wake, body);
  for (const int body : step_.fallenAsleep()) recordBody(EventKind::rest, body);
}

std::vector<Event> SoftSubsteps::takeEvents() {
  return std::exchange(events_, {});
}

}  // namespace cradle
