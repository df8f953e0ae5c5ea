#include "dynamics/integrators/semi_implicit_euler.h"

namespace cradle {

void semiImplicitEuler(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep,
                       Step& step) {
  beginStep(rightHandSide, state, time, timeStep, step);

  const Eigen::Index positions = rightHandSide.positions, others = state.size() - positions;
  step.state = state;
  step.state.tail(others) += timeStep * step.startDerivative.tail(others);
  rightHandSide.positionRate(step.state, step.work);
  step.state.head(positions) += timeStep * step.work.head(positions);
}

}  // namespace cradle
