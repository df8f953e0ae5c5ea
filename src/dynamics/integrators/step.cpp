#include "dynamics/integrators/step.h"

namespace cradle {

void prepareInterpolant(const RightHandSide& rightHandSide, Step& step) {
  step.endRate.resize(step.state.size());
  rightHandSide.rate(step.time + step.timeStep, step.state, step.endRate);
}

void interpolate(const Step& step, double fraction, VectorX& state) {
  const double s = fraction, r = 1 - fraction;
  state = (r * r * (1 + 2 * s)) * step.startState + (s * s * (1 + 2 * r)) * step.state +
          (step.timeStep * s * r) * (r * step.startRate - s * step.endRate);
}

}  // namespace cradle
