// A linear oscillator y = (x, x') goes through a step of any of the methods as y -> M y. Two trial steps give M, three
// give the quadratic form of the energy that is dissipated on the way; the rest is algebra. No table of limits is
// needed, and damping, which has limits of its own, is just another number.

#include "simulate/steps/step_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "math/elementary.h"

namespace cradle {
namespace {

constexpr double kGrowthRounding = 1e-7;   // of growth: roots of a double eigenvalue are that exact
constexpr double kVisibleGain = 0.1;       // of the energy, during a run
constexpr double kSafePart = 0.5;          // of the limit: stable, and a few per cent accurate in frequency
constexpr double kShortestStep = 1e-3;     // of the mode's time: what is unstable there has no limit
constexpr double kLimitTolerance = 1e-4;   // relative
constexpr double kMostTrialSteps = 10000;  // by then a stable motion has shown its largest error

/// What a step does to (x, x'), and what it dissipates: y^T dissipation y.
struct StepMap {
  Eigen::Matrix2d motion, dissipation;
};

StepMap stepMapOf(const SpringMode& mode, Integrator integrate, double timeStep) {
  const RightHandSide oscillator{[&mode](double, const VectorX& state, VectorX& rate) {
                                   rate.resize(3);
                                   rate << state[1], -mode.stiffness * state[0] - mode.damping * state[1],
                                       mode.damping * state[1] * state[1];
                                 },
                                 [](const VectorX& state, VectorX& rate) { rate[0] = state[1]; }, 1};
  const auto stepped = [&](double x, double v) {
    Step step;
    integrate(oscillator, Vec3(x, v, 0), 0, timeStep, step);
    return Vec3(step.state);
  };
  const double unit = 1 / timeStep;  // x and x' of one size: products of both are not lost
  const Vec3 a = stepped(1, 0), b = stepped(0, unit), both = stepped(1, unit);
  StepMap map;
  map.motion << a.head<2>(), b.head<2>() / unit;
  const double mixed = (both[2] - a[2] - b[2]) / 2 / unit;
  map.dissipation << a[2], mixed, mixed, b[2] / (unit * unit);
  return map;
}

/// The larger modulus of the eigenvalues.
double spectralRadius(const Eigen::Matrix2d& matrix) {
  const double halfTrace = matrix.trace() / 2, determinant = matrix.determinant();
  const double discriminant = halfTrace * halfTrace - determinant;
  return discriminant < 0 ? std::sqrt(determinant) : std::abs(halfTrace) + std::sqrt(discriminant);
}

/// Largest change of energy + dissipated, in parts of the energy at the start.
double largestEnergyError(const StepMap& map, const SpringMode& mode, const Eigen::Vector2d& start, double steps) {
  const auto energyOf = [&](const Eigen::Vector2d& y) { return (mode.stiffness * y[0] * y[0] + y[1] * y[1]) / 2; };
  Eigen::Vector2d y = start;
  double dissipated = 0, largest = 0;
  for (double step = 0; step < steps; ++step) {
    dissipated += y.dot(map.dissipation * y);
    y = map.motion * y;
    largest = std::max(largest, std::abs(energyOf(y) + dissipated - energyOf(start)));
  }
  return largest / energyOf(start);
}

double shortestTime(const SpringMode& mode) {
  return 1 / std::max(std::sqrt(mode.stiffness), mode.damping);
}

bool isStable(const SpringMode& mode, Integrator integrate, double timeStep) {
  return spectralRadius(stepMapOf(mode, integrate, timeStep).motion) <= 1 + kGrowthRounding;
}

std::string safeStepText(double limit) {
  return fmt::format("a timeStep of {:.2g} s is safe", kSafePart * limit);
}

std::string faultText(const SpringMode& mode, const ChosenMethod& method, double energyGain) {
  const double limit = longestStableStep(mode, method.integrate), frequency = std::sqrt(mode.stiffness);
  if (limit == 0)
    return fmt::format(
        "(omega {:.4g} rad/s) gains energy at any step of {}, {:.3g} times its own in this run; use semiImplicitEuler "
        "or rk4",
        frequency, method.name, energyGain);
  if (mode.damping > 2 * frequency)
    return fmt::format("has step x damping / mass = {:.3g} s x {:.4g} /s = {:.4g}, the limit of {} is {:.4g}; {}",
                       method.timeStep, mode.damping, method.timeStep * mode.damping, method.name, limit * mode.damping,
                       safeStepText(limit));
  return fmt::format("has step x omega = {:.3g} s x {:.4g} rad/s = {:.4g}, the limit of {} is {:.4g}; {}",
                     method.timeStep, frequency, method.timeStep * frequency, method.name, limit * frequency,
                     safeStepText(limit));
}

}  // namespace

ModeTrial tryMode(const SpringMode& mode, const ChosenMethod& method, double duration) {
  const StepMap map = stepMapOf(mode, method.integrate, method.timeStep);
  ModeTrial trial{spectralRadius(map.motion), 0};
  if (!(trial.growth <= 1 + kGrowthRounding)) return trial;
  const double steps = std::min(std::ceil(duration / method.timeStep), kMostTrialSteps);
  const double speed = std::max(std::sqrt(mode.stiffness), 1e-3 * mode.damping);  // of the unit of x
  for (const Eigen::Vector2d& start :
       {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, speed), Eigen::Vector2d(1, speed), Eigen::Vector2d(1, -speed)})
    if (mode.stiffness > 0 || start[1] != 0)
      trial.energyError = std::max(trial.energyError, largestEnergyError(map, mode, start, steps));
  return trial;
}

double longestStableStep(const SpringMode& mode, Integrator integrate) {
  double stable = shortestTime(mode);
  const double shortest = kShortestStep * stable;
  while (!isStable(mode, integrate, stable))
    if ((stable /= 2) < shortest) return 0;
  double unstable = 2 * stable;
  while (isStable(mode, integrate, unstable)) stable = unstable, unstable *= 2;
  while (unstable - stable > kLimitTolerance * stable) {
    const double middle = (stable + unstable) / 2;
    (isStable(mode, integrate, middle) ? stable : unstable) = middle;
  }
  return stable;
}

std::optional<StepFault> stepFault(const Mechanism& mechanism, const VectorX& state, const ChosenMethod& method,
                                   double duration) {
  if (method.isClosedForm() || method.isAdaptive()) return std::nullopt;
  for (const SpringMode& mode : {stiffestMode(mechanism, state), mostDampedMode(mechanism, state)}) {
    if (mode.stiffness == 0 && mode.damping == 0) continue;
    const double growth = tryMode(mode, method, duration).growth;
    const double steps = duration / method.timeStep;
    const double energyGain = growth <= 1 + kGrowthRounding ? 1 : cradle::exp(2 * steps * cradle::log(growth));
    if (energyGain < 1 + kVisibleGain) continue;
    return StepFault{mode.spring, faultText(mode, method, energyGain)};
  }
  return std::nullopt;
}

double springEnergyError(const Mechanism& mechanism, const VectorX& state, const ChosenMethod& method,
                         double duration) {
  double error = 0;
  if (method.isClosedForm() || method.isAdaptive()) return error;
  for (const SpringMode& mode : {stiffestMode(mechanism, state), mostDampedMode(mechanism, state)})
    if (mode.stiffness > 0 || mode.damping > 0) error = std::max(error, tryMode(mode, method, duration).energyError);
  return error;
}

}  // namespace cradle
