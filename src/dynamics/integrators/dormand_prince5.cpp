// J. R. Dormand, P. J. Prince, 1980, in the form of E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential
// Equations I", 2nd ed., II.5 (method, error estimate 5(4)) and II.6 (interpolant).

#include "dynamics/integrators/dormand_prince5.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "dynamics/integrators/dormand_prince5_table.h"

namespace cradle {
namespace {

using namespace dormand_prince5_table;

using Method = RungeKutta<kStages, kNodes, kEndDerivative>;

}  // namespace

void dormandPrince5(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep,
                    Step& step) {
  Method::advance(rightHandSide, state, time, timeStep, step);
  step.interpolant = InterpolantKind::degreeFour;
  evaluateEndDerivative(rightHandSide, step);
}

double dormandPrince5Error(const Step& step, const VectorX& tolerance) {
  CRADLE_CHECK(step.interpolant == InterpolantKind::degreeFour && step.hasEndDerivative);
  CRADLE_CHECK(tolerance.size() == step.state.size());
  const auto derivative = Method::derivatives(step);
  double largest = 0, finite = 0;
  for (Eigen::Index i = 0; i < step.state.size(); ++i) {
    const double size = std::max(std::abs(step.startState[i]), std::abs(step.state[i]));
    largest = std::max(largest, std::abs(weightedSum<kErrors, 0>(derivative, i)) / (tolerance[i] * (1 + size)));
    finite += 0 * step.state[i];  // NaN as soon as a component is not finite; std::max would pass over it
  }
  if (finite != 0) return std::numeric_limits<double>::quiet_NaN();
  return std::abs(step.timeStep) * largest;
}

void computeDormandPrince5Correction(Step& step) {
  step.work.setZero(step.startState.size());
  addDerivatives<kCorrections, 0>(Method::derivatives(step), step.timeStep, step.work, step.corrections[0]);
}

}  // namespace cradle
