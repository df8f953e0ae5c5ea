#include "dynamics/integrators/explicit_euler.h"

namespace cradle {

void explicitEuler(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  beginStep(rightHandSide, state, time, timeStep, step);
  step.state = state + timeStep * step.startDerivative;
}

}  // namespace cradle
