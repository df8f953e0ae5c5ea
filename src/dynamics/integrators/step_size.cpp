// E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential Equations I", 2nd ed., II.4: "Automatic step size
// control" and "Starting step size", with the constants of their program dop853.f, and largest errors for mean ones.

#include "dynamics/integrators/step_size.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "math/elementary.h"

namespace cradle {
namespace {

// The step-size control of E. Hairer, S. P. Norsett, G. Wanner, II.4, with their values for DOP853.
constexpr double kSafety = 0.9;
constexpr double kMaxGrowth = 6;
constexpr double kMaxShrinking = 1.0 / 3;

constexpr double kFirstRatio = 0.01;     // of the state's size: change of the state in the first guess
constexpr double kSmallestSize = 1e-10;  // of the state or its derivative, in tolerances: below, they say nothing
constexpr double kBlindTimeStep = 1e-6;  // s: taken when they say nothing
constexpr double kStraightRate = 1e-15;  // in tolerances: a motion without curvature

/// Square roots are rounded the same everywhere, powers are not.
double rootOf(double x, int order) {
  CRADLE_CHECK(order == 8 || order == 5);
  return order == 8 ? std::sqrt(std::sqrt(std::sqrt(x))) : exp(log(x) / 5);
}

/// Largest component in units of the tolerance at `state`.
template <class Vector>
double sizeOf(const Vector& vector, const VectorX& state, const VectorX& tolerance) {
  double largest = 0;
  for (Eigen::Index i = 0; i < state.size(); ++i)
    largest = std::max(largest, std::abs(vector[i]) / (tolerance[i] * (1 + std::abs(state[i]))));
  return largest;
}

}  // namespace

bool acceptStep(double errorNorm, double taken, StepSize& size) {
  const bool accepted = errorNorm <= 1;
  const double growth = std::isfinite(errorNorm)
                            ? std::clamp(kSafety / rootOf(errorNorm, size.order), kMaxShrinking, kMaxGrowth)
                            : kMaxShrinking;
  const double planned = size.timeStep;
  size.timeStep = taken * growth;
  if (accepted) {
    if (size.afterRejection) size.timeStep = std::min(size.timeStep, taken);
    if (growth == kMaxGrowth) size.timeStep = std::max(size.timeStep, planned);
  }
  size.afterRejection = !accepted;
  return accepted;
}

double firstTimeStep(const RightHandSide& rightHandSide, const VectorX& tolerance, Step& step, int order) {
  CRADLE_CHECK(tolerance.size() == step.startState.size());
  const VectorX& start = step.startState;
  const double size = sizeOf(start, start, tolerance), derivative = sizeOf(step.startDerivative, start, tolerance);
  const double guess =
      size < kSmallestSize || derivative < kSmallestSize ? kBlindTimeStep : kFirstRatio * size / derivative;

  step.stage = start + guess * step.startDerivative;
  step.work.resize(start.size());
  rightHandSide.derivative(step.time + guess, step.stage, step.work);
  const double curvature = sizeOf(step.work - step.startDerivative, start, tolerance) / guess;

  keepStartDerivative(step);
  const double fastest = std::max(derivative, curvature);
  if (fastest <= kStraightRate) return std::max(kBlindTimeStep, guess * 1e-3);
  return std::min(100 * guess, rootOf(kFirstRatio / fastest, order));
}

}  // namespace cradle
