#include "dynamics/integrators/dormand_prince5.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "dynamics/integrator_problems.h"
#include "dynamics/integrators/dormand_prince5_table.h"

namespace cradle {
namespace {

using namespace dormand_prince5_table;

constexpr double kRounding = 1e-14;  // sums of 7 products of numbers up to 12, against 1e-16 each

double sumOf(const Weights& weights, int power) {
  double sum = 0;
  for (std::size_t i = 0; i < kDerivatives; ++i) sum += weights[i] * std::pow(kNodes[i], power);
  return sum;
}

TEST(DormandPrince5Table, EveryStageUsesOnlyRatesBeforeItAndItsWeightsAddUpToItsNode) {
  for (std::size_t i = 0; i < kDerivatives; ++i) {
    for (std::size_t j = i; j < kDerivatives; ++j) EXPECT_EQ(kStages[i][j], 0) << i << " " << j;
    EXPECT_NEAR(sumOf(kStages[i], 0), kNodes[i], kRounding) << i;
  }
}

// y' = t^k is exact for k < 5 with the result, and for k < 4 with the embedded formula; not beyond.
TEST(DormandPrince5Table, ResultIsOfOrderFiveAndItsErrorEstimateOfOrderFour) {
  for (int k = 0; k < 5; ++k) EXPECT_NEAR(sumOf(kStages[kEndDerivative], k), 1.0 / (k + 1), kRounding) << k;
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(sumOf(kErrors[0], k), 0, kRounding) << k;
  EXPECT_GT(std::abs(sumOf(kStages[kEndDerivative], 5) - 1.0 / 6), 1e-4);
  EXPECT_GT(std::abs(sumOf(kErrors[0], 4)), 1e-4);
}

// The error is C h^5 (1 + c h + ...): of an ellipse's nearest point, halving steps of 1/40 shows c h as a fifth of an
// order, and steps of a circle, whose errors of odd orders cancel, (c h)^2 as a fortieth.
TEST(DormandPrince5, IsOfOrderFive) {
  const auto error = [](int steps) {
    return (stateAfter(dormandPrince5, kepler(), keplerAt(0), 2, steps) - keplerAt(2)).norm();
  };
  EXPECT_NEAR(orderOf(error(80), error(160)), 5, 0.3);
  EXPECT_LT(error(80), 1e-7);
  const auto swing = [](int steps) {
    return (stateAfter(dormandPrince5, oscillator(1), oscillatorAt(1, 0), 10, steps) - oscillatorAt(1, 10)).norm();
  };
  EXPECT_NEAR(orderOf(swing(40), swing(80)), 5, 0.03);
}

// The local error of an interpolant of order 4.
TEST(DormandPrince5, InterpolantHasALocalErrorOfTheFifthPower) {
  EXPECT_NEAR(orderOf(interpolationError(dormandPrince5, 0.2), interpolationError(dormandPrince5, 0.1)), 5, 0.2);
  EXPECT_LT(interpolationError(dormandPrince5, 0.1), 1e-6);
}

// So that a state within a step is nearly as good as the step is judged to be: both fall as the fifth power of the
// step, and their ratio, that of two constants, stays between 2 and 3.
TEST(DormandPrince5, ErrorEstimateIsOfTheSizeOfTheInterpolantsError) {
  const VectorX tolerance = VectorX::Constant(4, 1e-8);
  const auto norm = [&](double timeStep) {
    return dormandPrince5Error(keplerStep(dormandPrince5, 0.4, timeStep), tolerance);
  };
  EXPECT_NEAR(orderOf(norm(0.1), norm(0.05)), 5, 0.3);
  for (const double timeStep : {0.2, 0.1, 0.05}) {
    const double estimate = norm(timeStep) * 1e-8 * 2.4;  // components of size 1.4 at most
    EXPECT_LT(interpolationError(dormandPrince5, timeStep), 3 * estimate) << timeStep;
    EXPECT_GT(interpolationError(dormandPrince5, timeStep), 2 * estimate) << timeStep;
  }
  const double error = (keplerStep(dormandPrince5, 0.4, 0.1).state - keplerAt(0.5)).norm();
  EXPECT_LT(error, norm(0.1) * 1e-8 * 2.4);
}

TEST(DormandPrince5, ErrorOfAStepOutOfTheFiniteNumbersIsNotANumber) {
  EXPECT_TRUE(std::isnan(dormandPrince5Error(stepOutOfFiniteNumbers(dormandPrince5), VectorX::Constant(2, 1e-6))));
}

// Six rates, the last of which the next step begins with; its interpolant needs none.
TEST(DormandPrince5, TakesSixEvaluations) {
  int evaluations = 0;
  const RightHandSide counted{[&](double time, const VectorX& state, VectorX& rate) {
                                ++evaluations;
                                kepler().derivative(time, state, rate);
                              },
                              nullptr, 0};
  Step step;
  dormandPrince5(counted, keplerAt(0), 0, 0.1, step);
  prepareInterpolant(counted, step);
  EXPECT_EQ(evaluations, 7);
  const VectorX end = step.state;
  carryEndDerivative(step);
  dormandPrince5(counted, end, 0.1, 0.1, step);
  EXPECT_EQ(evaluations, 13);
}

}  // namespace
}  // namespace cradle
