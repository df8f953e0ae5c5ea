// W. Kutta, "Beitrag zur naeherungsweisen Integration totaler Differentialgleichungen", 1901: weights 1/6, 1/3, 1/3,
// 1/6.

#include "dynamics/integrators/rk4.h"

namespace cradle {

void rk4(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  beginStep(rightHandSide, state, time, timeStep, step);

  VectorX& k = step.work;
  step.state = state + (timeStep / 6) * step.startRate;

  step.stage = state + (timeStep / 2) * step.startRate;
  rightHandSide.rate(time + timeStep / 2, step.stage, k);
  step.state += (timeStep / 3) * k;

  step.stage = state + (timeStep / 2) * k;
  rightHandSide.rate(time + timeStep / 2, step.stage, k);
  step.state += (timeStep / 3) * k;

  step.stage = state + timeStep * k;
  rightHandSide.rate(time + timeStep, step.stage, k);
  step.state += (timeStep / 6) * k;
}

}  // namespace cradle
