#include "study/stability/logistic_equation.h"

#include "math/elementary.h"

namespace cradle {

double logisticSolution(double time) {
  return kLogisticEnd / (1 + (kLogisticEnd / kLogisticStart - 1) * cradle::exp(-kLogisticGrowth * time));
}

std::vector<double> logisticSteps(Integrator integrate, double timeStep, int steps) {
  const RightHandSide logistic{[](double, const VectorX& state, VectorX& rate) {
                                 rate.resize(1);
                                 rate[0] = (kLogisticGrowth - kLogisticLoss * state[0]) * state[0];
                               },
                               [](const VectorX&, VectorX&) {}, 0};
  Step step;
  VectorX state = VectorX::Constant(1, kLogisticStart);
  std::vector<double> values = {state[0]};
  for (int i = 0; i < steps; ++i) {
    integrate(logistic, state, i * timeStep, timeStep, step);
    state = step.state;
    values.push_back(state[0]);
  }
  return values;
}

}  // namespace cradle
