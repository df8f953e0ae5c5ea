// J. R. Dormand, P. J. Prince, 1980, in the form of E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential
// Equations I", 2nd ed., II.5 (method, error estimate 5(3)) and II.6 (interpolant).

#include "dynamics/integrators/dop853.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "dynamics/integrators/dop853_table.h"

namespace cradle {
namespace {

using namespace dop853_table;

using Method = RungeKutta<kStages, kNodes, kEndDerivative>;

}  // namespace

void dop853(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  Method::advance(rightHandSide, state, time, timeStep, step);
  step.interpolant = InterpolantKind::degreeSeven;
}

double dop853Error(const Step& step, const VectorX& tolerance) {
  CRADLE_CHECK(step.interpolant == InterpolantKind::degreeSeven);
  CRADLE_CHECK(tolerance.size() == step.state.size());
  const auto derivative = Method::derivatives(step);
  double fifth = 0, third = 0, finite = 0;
  for (Eigen::Index i = 0; i < step.state.size(); ++i) {
    const double size = std::max(std::abs(step.startState[i]), std::abs(step.state[i]));
    const double scale = 1 / (tolerance[i] * (1 + size));
    fifth = std::max(fifth, std::abs(weightedSum<kErrors, 0>(derivative, i)) * scale);
    third = std::max(third, std::abs(weightedSum<kErrors, 1>(derivative, i)) * scale);
    finite += 0 * step.state[i];  // NaN as soon as a component is not finite; std::max would pass over it
  }
  if (finite != 0) return std::numeric_limits<double>::quiet_NaN();
  if (fifth == 0) return 0;
  return std::abs(step.timeStep) * fifth * fifth / std::sqrt(fifth * fifth + 0.01 * third * third);
}

void dop853Corrections(const RightHandSide& rightHandSide, Step& step) {
  Method::evaluateStage<kEndDerivative + 1>(rightHandSide, step);
  Method::evaluateStage<kEndDerivative + 2>(rightHandSide, step);
  Method::evaluateStage<kEndDerivative + 3>(rightHandSide, step);
  step.work.setZero(step.startState.size());
  [&]<std::size_t... kRow>(std::index_sequence<kRow...>) {
    (addDerivatives<kCorrections, kRow>(Method::derivatives(step), step.timeStep, step.work, step.corrections[kRow]),
     ...);
  }
  (std::make_index_sequence<kCorrections.size()>());
}

}  // namespace cradle
