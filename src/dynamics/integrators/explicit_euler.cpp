#include "dynamics/integrators/explicit_euler.h"

namespace cradle {

void explicitEuler(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  step.time = time;
  step.timeStep = timeStep;
  step.startState = state;
  step.startRate.resize(state.size());
  rightHandSide.rate(time, state, step.startRate);
  step.state = state + timeStep * step.startRate;
}

}  // namespace cradle
