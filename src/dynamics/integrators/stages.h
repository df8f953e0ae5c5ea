#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "dynamics/integrators/step.h"

namespace cradle {

/// Weights of the rates of a step in a sum; those left out are 0.
template <std::size_t kRates>
using RateWeights = std::array<double, kRates>;

/// The rates of a Runge-Kutta step: Step::stageRates, but for those at its start and its end, the rate `kEndRate`.
template <std::size_t kRates>
using RatePointers = std::array<const double*, kRates>;

template <std::size_t kRates, std::size_t kEndRate>
RatePointers<kRates> ratesOf(const Step& step) {
  RatePointers<kRates> rates;
  for (std::size_t i = 0; i < kRates; ++i) rates[i] = step.stageRates[i].data();
  rates[0] = step.startRate.data();
  rates[kEndRate] = step.endRate.data();
  return rates;
}

/// Sum of a component of all rates with the weights of a row of a table, in the order of the rates: the same bits
/// whether the compiler takes one component at a time or several.
template <const auto& kTable, std::size_t kRow, class Rates>
double weightedSum(const Rates& rates, Eigen::Index component) {
  double sum = 0;
  const auto addTerm = [&]<std::size_t kColumn>() {
    if constexpr (kTable[kRow][kColumn] != 0) sum += kTable[kRow][kColumn] * rates[kColumn][component];
  };
  [&]<std::size_t... kColumn>(std::index_sequence<kColumn...>) {
    (addTerm.template operator()<kColumn>(), ...);
  }
  (std::make_index_sequence<kTable[kRow].size()>());
  return sum;
}

/// target = start + timeStep x weighted sum of the rates, in one pass over the components.
template <const auto& kTable, std::size_t kRow, class Rates>
void addRates(const Rates& rates, double timeStep, const VectorX& start, VectorX& target) {
  target.resize(start.size());
  const double* from = start.data();
  double* to = target.data();
  const Eigen::Index size = start.size();
// The target is none of the sources: several components at a time.
#pragma GCC ivdep
  for (Eigen::Index i = 0; i < size; ++i) to[i] = from[i] + timeStep * weightedSum<kTable, kRow>(rates, i);
}

/// An explicit Runge-Kutta method by its table: kStages and kNodes as in dormand_prince5_table.h, row kEndRate its
/// result.
template <const auto& kStages, const auto& kNodes, std::size_t kEndRate>
struct RungeKutta {
  static auto rates(const Step& step) { return ratesOf<kNodes.size(), kEndRate>(step); }

  template <std::size_t kRow>
  static void evaluateStage(const RightHandSide& rightHandSide, Step& step) {
    addRates<kStages, kRow>(rates(step), step.timeStep, step.startState, step.stage);
    step.stageRates[kRow].resize(step.stage.size());
    rightHandSide.rate(step.time + kNodes[kRow] * step.timeStep, step.stage, step.stageRates[kRow]);
  }

  /// The state at the end of the step, and all rates before that.
  static void advance(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep,
                      Step& step) {
    beginStep(rightHandSide, state, time, timeStep, step);
    if (step.stageRates.size() < kNodes.size()) step.stageRates.resize(kNodes.size());
    [&]<std::size_t... kStage>(std::index_sequence<kStage...>) {
      (evaluateStage<kStage + 1>(rightHandSide, step), ...);
    }
    (std::make_index_sequence<kEndRate - 1>());
    addRates<kStages, kEndRate>(rates(step), timeStep, step.startState, step.state);
  }
};

}  // namespace cradle
