// A step of any of the methods maps a linear oscillator x'' = -k x - c x' by y -> M y, y = (x, x'). Two trial steps
// give M, a third the quadratic form of the energy that is dissipated on the way. A step is stable if the spectral
// radius of M is at most 1. So no table of limits is needed, and the damping c, which has limits of its own, is just a
// number.

#include "simulate/steps/step_limit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/elementary.h"

namespace cradle {
namespace {

constexpr double kGrowthRounding = 1e-7;  // of growth: roots of a double eigenvalue are that exact
constexpr double kVisibleGain = 0.1;      // of the energy, during a run
constexpr double kSafeRatio = 0.5;        // of the limit: stable, and a few per cent accurate in frequency
constexpr double kShortestStep = 1e-3;    // of the mode's time: a method that is unstable there has no stable step
constexpr double kLimitTolerance = 1e-4;  // relative
constexpr double kMaxTrialSteps = 10000;  // by then a stable motion has shown its largest error
constexpr double kVisibleChange = 0.01;   // of the energy, in a period of a stable mode: 5 % of the swing in ten
constexpr double kMinStepOmega = 1e-4;    // explicit Euler gains 1 % in a period from 1.6e-3 on, others need less care
constexpr double kToldFraction = 0.9;     // of a step, of which two digits are told: they may be 5 % too long

/// The map of a step, y -> motion y, and the energy that it dissipates: y^T dissipation y.
struct StepMap {
  Eigen::Matrix2d motion, dissipation;
};

StepMap stepMapOf(const SpringMode& mode, Integrator integrate, double timeStep) {
  const RightHandSide oscillator{[&mode](double, const VectorX& state, VectorX& derivative) {
                                   derivative.resize(3);
                                   derivative << state[1], -mode.stiffness * state[0] - mode.damping * state[1],
                                       mode.damping * state[1] * state[1];
                                 },
                                 [](const VectorX& state, VectorX& derivative) { derivative[0] = state[1]; }, 1};
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

/// Largest change of energy + dissipated, as a fraction of the energy at the start.
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
  return fmt::format("a timeStep of {:.2g} s is safe", kSafeRatio * limit);
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

/// The relative change of a mode's energy in a period P that comes of the steps alone: |M|^(2 P / h) - exp(-c P), |M|
/// the spectral radius. < 0 is a loss. 0 for an overdamped mode, which does not swing.
double changeInAPeriod(const SpringMode& mode, Integrator integrate, double timeStep) {
  const double frequency = std::sqrt(mode.stiffness);
  if (mode.damping >= 2 * frequency) return 0;
  const double period = 2 * std::numbers::pi / frequency;
  const double growth = spectralRadius(stepMapOf(mode, integrate, timeStep).motion);
  return cradle::exp(2 * period / timeStep * cradle::log(growth)) - cradle::exp(-mode.damping * period);
}

/// The longest step (s) up to `timeStep` with which that change is hardly seen, to 1e-4; 0 if there is none.
double longestHarmlessStep(const SpringMode& mode, Integrator integrate, double timeStep) {
  const auto isHarmless = [&](double step) {
    return std::abs(changeInAPeriod(mode, integrate, step)) < kVisibleChange;
  };
  double harmless = timeStep;
  while (!isHarmless(harmless))
    if ((harmless /= 2) * std::sqrt(mode.stiffness) < kMinStepOmega) return 0;
  double harmful = 2 * harmless;
  while (harmful - harmless > kLimitTolerance * harmless) {
    const double middle = (harmless + harmful) / 2;
    (isHarmless(middle) ? harmless : harmful) = middle;
  }
  return harmless;
}

std::string changeText(const SpringMode& mode, const ChosenMethod& method, double change) {
  const double frequency = std::sqrt(mode.stiffness), percent = 100 * std::abs(change);
  const double harmless = longestHarmlessStep(mode, method.integrate, method.timeStep);
  const std::string remedy =
      harmless > 0 ? fmt::format("with a timeStep of {:.2g} s it is below 1 %", kToldFraction * harmless) : "use rk4";
  return fmt::format(
      "{} {} % of its energy in a period by the steps of {} alone: step x omega = {:.3g} s x {:.4g} rad/s = {:.4g}; "
      "{}",
      change < 0 ? "loses" : "gains", percent >= 10 ? fmt::format("{:.0f}", percent) : fmt::format("{:.2g}", percent),
      method.name, method.timeStep, frequency, method.timeStep * frequency, remedy);
}

/// The stiffest mode, and each spring on its own.
std::vector<SpringMode> swingingModes(const Mechanism& mechanism, const VectorX& state) {
  std::vector<SpringMode> modes{stiffestMode(mechanism, state)};
  for (std::size_t i = 0; i < mechanism.springs.size(); ++i) {
    const SpringForce& spring = mechanism.springs[i];
    const double frequency = naturalFrequency(spring, mechanism.bodies, state), square = frequency * frequency;
    if (spring.stiffness > 0) modes.push_back({square, square * spring.damping / spring.stiffness, i});
  }
  std::erase_if(modes, [](const SpringMode& mode) { return !(mode.stiffness > 0); });
  return modes;
}

}  // namespace

ModeTrial tryMode(const SpringMode& mode, const ChosenMethod& method, double duration) {
  const StepMap map = stepMapOf(mode, method.integrate, method.timeStep);
  ModeTrial trial{spectralRadius(map.motion), 0};
  if (!(trial.growth <= 1 + kGrowthRounding)) return trial;
  const double steps = std::min(std::ceil(duration / method.timeStep), kMaxTrialSteps);
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

std::optional<StepFault> energyChangeByStep(const Mechanism& mechanism, const VectorX& state,
                                            const ChosenMethod& method, double duration) {
  if (method.isClosedForm() || method.isAdaptive() || mechanism.springs.empty()) return std::nullopt;
  SpringMode worst;
  double most = 0;
  for (const SpringMode& mode : swingingModes(mechanism, state)) {
    const double periods = duration * std::sqrt(mode.stiffness) / (2 * std::numbers::pi);
    const double change = changeInAPeriod(mode, method.integrate, method.timeStep);
    if (std::abs(change) * std::min(periods, 1.0) < kVisibleChange || std::abs(change) <= std::abs(most)) continue;
    most = change, worst = mode;
  }
  if (most == 0) return std::nullopt;
  return StepFault{worst.spring, changeText(worst, method, most)};
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
