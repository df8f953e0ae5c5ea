// W. Kutta, "Beitrag zur naeherungsweisen Integration totaler Differentialgleichungen", 1901: weights 1/6, 1/3, 1/3,
// 1/6. With the end derivative in place of the fourth stage it is of order 3 (E. Hairer, S. P. Norsett, G. Wanner,
// "Solving Ordinary Differential Equations I", II.4: embedded formulas): the difference of both is an estimate of the
// error.

#include "dynamics/integrators/rk4.h"

#include <algorithm>
#include <cmath>

namespace cradle {

void rk4(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  beginStep(rightHandSide, state, time, timeStep, step);

  VectorX& k = step.work;
  step.state = state + (timeStep / 6) * step.startDerivative;

  step.stage = state + (timeStep / 2) * step.startDerivative;
  rightHandSide.derivative(time + timeStep / 2, step.stage, k);
  step.state += (timeStep / 3) * k;

  step.stage = state + (timeStep / 2) * k;
  rightHandSide.derivative(time + timeStep / 2, step.stage, k);
  step.state += (timeStep / 3) * k;

  step.stage = state + timeStep * k;
  rightHandSide.derivative(time + timeStep, step.stage, k);
  step.state += (timeStep / 6) * k;
}

double rk4Error(const Step& step, Eigen::Index components) {
  double largest = 0;
  for (Eigen::Index i = 0; i < components; ++i) {
    const double error =
        step.timeStep / 6 * std::abs(step.work[i] - step.endDerivative[i]) / (1 + std::abs(step.state[i]));
    if (!std::isfinite(error)) return NAN;
    largest = std::max(largest, error);
  }
  return largest;
}

}  // namespace cradle
