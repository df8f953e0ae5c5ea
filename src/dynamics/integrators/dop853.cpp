// J. R. Dormand, P. J. Prince, 1980, in the form of E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential
// Equations I", 2nd ed., II.5 (method, error estimate 5(3)) and II.6 (interpolant).
// Each weighted sum of rates is one pass over the components, its terms in the order of the stages: the same bits
// whether the compiler takes one component at a time or several.

#include "dynamics/integrators/dop853.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "dynamics/integrators/dop853_table.h"

namespace cradle {
namespace {

using namespace dop853_table;

using RatePointers = std::array<const double*, kRates>;

RatePointers ratesOf(const Step& step) {
  RatePointers rates;
  for (std::size_t i = 0; i < kRates; ++i) rates[i] = step.stageRates[i].data();
  rates[0] = step.startRate.data();
  rates[kEndRate] = step.endRate.data();
  return rates;
}

template <const auto& kTable, std::size_t kRow, std::size_t kColumn>
void addTerm(const RatePointers& rates, Eigen::Index component, double& sum) {
  if constexpr (kTable[kRow][kColumn] != 0) sum += kTable[kRow][kColumn] * rates[kColumn][component];
}

/// Sum of a component of all rates with the weights of a row of a table.
template <const auto& kTable, std::size_t kRow>
double weightedSum(const RatePointers& rates, Eigen::Index component) {
  double sum = 0;
  [&]<std::size_t... kColumn>(std::index_sequence<kColumn...>) {
    (addTerm<kTable, kRow, kColumn>(rates, component, sum), ...);
  }
  (std::make_index_sequence<kRates>());
  return sum;
}

/// target = start + h x weighted sum of the rates.
template <const auto& kTable, std::size_t kRow>
void addRates(const Step& step, const VectorX& start, VectorX& target) {
  target.resize(start.size());
  const RatePointers rates = ratesOf(step);
  const double* from = start.data();
  double* to = target.data();
  const double timeStep = step.timeStep;
  const Eigen::Index size = start.size();
// The target is none of the sources: several components at a time.
#pragma GCC ivdep
  for (Eigen::Index i = 0; i < size; ++i) to[i] = from[i] + timeStep * weightedSum<kTable, kRow>(rates, i);
}

template <std::size_t kRow>
void evaluateStage(const RightHandSide& rightHandSide, Step& step) {
  addRates<kStages, kRow>(step, step.startState, step.stage);
  step.stageRates[kRow].resize(step.stage.size());
  rightHandSide.rate(step.time + kNodes[kRow] * step.timeStep, step.stage, step.stageRates[kRow]);
}

}  // namespace

void dop853(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  beginStep(rightHandSide, state, time, timeStep, step);
  step.interpolant = InterpolantKind::degreeSeven;
  step.stageRates.resize(kRates);
  [&]<std::size_t... kStage>(std::index_sequence<kStage...>) {
    (evaluateStage<kStage + 1>(rightHandSide, step), ...);
  }
  (std::make_index_sequence<kEndRate - 1>());
  addRates<kStages, kEndRate>(step, step.startState, step.state);
}

double errorNorm(const Step& step, const VectorX& tolerance) {
  CRADLE_CHECK(step.interpolant == InterpolantKind::degreeSeven);
  CRADLE_CHECK(tolerance.size() == step.state.size());
  const RatePointers rates = ratesOf(step);
  double fifth = 0, third = 0, finite = 0;
  for (Eigen::Index i = 0; i < step.state.size(); ++i) {
    const double size = std::max(std::abs(step.startState[i]), std::abs(step.state[i]));
    const double scale = 1 / (tolerance[i] * (1 + size));
    fifth = std::max(fifth, std::abs(weightedSum<kErrors, 0>(rates, i)) * scale);
    third = std::max(third, std::abs(weightedSum<kErrors, 1>(rates, i)) * scale);
    finite += 0 * step.state[i];  // NaN as soon as a component is not finite; std::max would pass over it
  }
  if (finite != 0) return std::numeric_limits<double>::quiet_NaN();
  if (fifth == 0) return 0;
  return std::abs(step.timeStep) * fifth * fifth / std::sqrt(fifth * fifth + 0.01 * third * third);
}

void computeCorrections(const RightHandSide& rightHandSide, Step& step) {
  evaluateStage<kEndRate + 1>(rightHandSide, step);
  evaluateStage<kEndRate + 2>(rightHandSide, step);
  evaluateStage<kEndRate + 3>(rightHandSide, step);
  step.work.setZero(step.startState.size());
  [&]<std::size_t... kRow>(std::index_sequence<kRow...>) {
    (addRates<kCorrections, kRow>(step, step.work, step.corrections[kRow]), ...);
  }
  (std::make_index_sequence<kCorrections.size()>());
}

}  // namespace cradle
