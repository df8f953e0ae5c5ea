#include "dynamics/integrators/step.h"

#include "core/error.h"

namespace cradle {

void beginStep(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  step.time = time;
  step.timeStep = timeStep;
  step.startState = state;
  step.startRate.resize(state.size());
  step.work.resize(state.size());
  step.hasEndRate = false;
  rightHandSide.rate(time, state, step.startRate);
}

void prepareInterpolant(const RightHandSide& rightHandSide, Step& step) {
  if (step.hasEndRate) return;
  step.hasEndRate = true;
  step.endRate.resize(step.state.size());
  rightHandSide.rate(step.time + step.timeStep, step.state, step.endRate);
}

void interpolate(const Step& step, double fraction, VectorX& state) {
  CRADLE_CHECK(step.hasEndRate);
  const double s = fraction, r = 1 - fraction;
  state = (r * r * (1 + 2 * s)) * step.startState + (s * s * (1 + 2 * r)) * step.state +
          (step.timeStep * s * r) * (r * step.startRate - s * step.endRate);
}

}  // namespace cradle
