#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "dynamics/integrators/step.h"

namespace cradle {

/// Weights of the derivatives of a step in a sum; those left out are 0.
template <std::size_t kDerivatives>
using DerivativeWeights = std::array<double, kDerivatives>;

/// The derivatives of a Runge-Kutta step: Step::stageDerivatives, but for those at its start and its end, the
/// derivative `kEndDerivative`.
template <std::size_t kDerivatives>
using DerivativePointers = std::array<const double*, kDerivatives>;

template <std::size_t kDerivatives, std::size_t kEndDerivative>
DerivativePointers<kDerivatives> derivativesOf(const Step& step) {
  DerivativePointers<kDerivatives> derivatives;
  for (std::size_t i = 0; i < kDerivatives; ++i) derivatives[i] = step.stageDerivatives[i].data();
  derivatives[0] = step.startDerivative.data();
  derivatives[kEndDerivative] = step.endDerivative.data();
  return derivatives;
}

/// Sum of a component of all derivatives with the weights of a row of a table, in the order of the derivatives: the
/// same bits whether the compiler takes one component at a time or several.
template <const auto& kTable, std::size_t kRow, class Derivatives>
double weightedSum(const Derivatives& derivatives, Eigen::Index component) {
  double sum = 0;
  const auto addTerm = [&]<std::size_t kColumn>() {
    if constexpr (kTable[kRow][kColumn] != 0) sum += kTable[kRow][kColumn] * derivatives[kColumn][component];
  };
  [&]<std::size_t... kColumn>(std::index_sequence<kColumn...>) {
    (addTerm.template operator()<kColumn>(), ...);
  }
  (std::make_index_sequence<kTable[kRow].size()>());
  return sum;
}

/// target = start + timeStep x weighted sum of the derivatives, in one pass over the components.
template <const auto& kTable, std::size_t kRow, class Derivatives>
void addDerivatives(const Derivatives& derivatives, double timeStep, const VectorX& start, VectorX& target) {
  target.resize(start.size());
  const double* from = start.data();
  double* to = target.data();
  const Eigen::Index size = start.size();
// The target is none of the sources: several components at a time.
#pragma GCC ivdep
  for (Eigen::Index i = 0; i < size; ++i) to[i] = from[i] + timeStep * weightedSum<kTable, kRow>(derivatives, i);
}

/// An explicit Runge-Kutta method by its table: kStages and kNodes as in dormand_prince5_table.h, row kEndDerivative
/// its result.
template <const auto& kStages, const auto& kNodes, std::size_t kEndDerivative>
struct RungeKutta {
  static auto derivatives(const Step& step) { return derivativesOf<kNodes.size(), kEndDerivative>(step); }

  template <std::size_t kRow>
  static void evaluateStage(const RightHandSide& rightHandSide, Step& step) {
    addDerivatives<kStages, kRow>(derivatives(step), step.timeStep, step.startState, step.stage);
    step.stageDerivatives[kRow].resize(step.stage.size());
    rightHandSide.derivative(step.time + kNodes[kRow] * step.timeStep, step.stage, step.stageDerivatives[kRow]);
  }

  /// The state at the end of the step, and all derivatives before that.
  static void advance(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep,
                      Step& step) {
    beginStep(rightHandSide, state, time, timeStep, step);
    if (step.stageDerivatives.size() < kNodes.size()) step.stageDerivatives.resize(kNodes.size());
    [&]<std::size_t... kStage>(std::index_sequence<kStage...>) {
      (evaluateStage<kStage + 1>(rightHandSide, step), ...);
    }
    (std::make_index_sequence<kEndDerivative - 1>());
    addDerivatives<kStages, kEndDerivative>(derivatives(step), timeStep, step.startState, step.state);
  }
};

}  // namespace cradle
