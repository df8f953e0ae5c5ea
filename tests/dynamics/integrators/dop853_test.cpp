#include "dynamics/integrators/dop853.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "dynamics/integrator_problems.h"
#include "dynamics/integrators/dop853_table.h"

namespace cradle {
namespace {

TEST(Dop853, IsOfOrderEightOnTheOscillator) {
  const auto error = [](int steps) {
    return (stateAfter(dop853, oscillator(1), oscillatorAt(1, 0), 10, steps) - oscillatorAt(1, 10)).norm();
  };
  EXPECT_NEAR(orderOf(error(10), error(20)), 8, 0.3);
  EXPECT_LT(error(20), 1e-6);
}

TEST(Dop853, IsOfOrderEightOnAnEllipse) {
  const auto error = [](int steps) {
    return (stateAfter(dop853, kepler(), keplerAt(0), 2, steps) - keplerAt(2)).norm();
  };
  EXPECT_NEAR(orderOf(error(8), error(16)), 8, 0.5);
  EXPECT_LT(error(8), 1e-7);
}

// |R(i z)| of its stability polynomial is 1 at z = 5.9606: 0.90 at 5.9, 1.077 at 6.
TEST(Dop853, OscillatorIsStableUpToStepTimesOmegaFivePointNineSix) {
  const auto farthest = [](double omega) {
    return stateAfter(dop853, oscillator(omega), oscillatorAt(omega, 0), 100, 100).norm();
  };
  EXPECT_LT(farthest(5.96), 6);
  EXPECT_LT(farthest(5.9), 1e-3);
  EXPECT_GT(farthest(6.0), 1e3);
}

// The local error of an interpolant of order 7.
TEST(Dop853, InterpolantHasALocalErrorOfTheEighthPower) {
  EXPECT_NEAR(orderOf(interpolationError(dop853, 0.2), interpolationError(dop853, 0.1)), 8, 0.5);
  EXPECT_LT(interpolationError(dop853, 0.2), 1e-7);
}

TEST(Dop853, InterpolantIsExactAtBothEndsWithItsSlope) {
  const Step step = keplerStep(dop853, 1, 0.5);
  VectorX state, near;
  interpolate(step, 0, state);
  EXPECT_EQ(state, step.startState);
  interpolate(step, 1, state);
  EXPECT_EQ(state, step.state);
  const double delta = 1e-6;  // of the step: one-sided slope good to delta x velocityProduct, some 1e-6
  interpolate(step, delta, near);
  EXPECT_LT(((near - step.startState) / (delta * step.timeStep) - step.startDerivative).norm(), 1e-5);
  interpolate(step, 1 - delta, near);
  EXPECT_LT(((step.state - near) / (delta * step.timeStep) - step.endDerivative).norm(), 1e-5);
}

// The error estimate falls with the eighth power of the step, the error itself with the ninth: the estimate is the
// larger the smaller the step.
TEST(Dop853, ErrorNormIsOfTheEighthPowerAndAboveTheError) {
  const VectorX tolerance = VectorX::Constant(4, 1e-8);
  const auto norm = [&](double timeStep) { return dop853Error(keplerStep(dop853, 0.4, timeStep), tolerance); };
  EXPECT_NEAR(orderOf(norm(0.1), norm(0.05)), 8, 0.3);
  for (const double timeStep : {0.8, 0.4, 0.2}) {
    const Step step = keplerStep(dop853, 0.4, timeStep);
    const VectorX exact = keplerAt(0.4 + timeStep);
    const double error =
        ((step.state - exact).array() / (tolerance.array() * (1 + exact.array().abs()))).abs().maxCoeff();
    EXPECT_GT(norm(timeStep), error) << timeStep;
    EXPECT_LT(norm(timeStep), 1e3 * error) << timeStep;
  }
}

// y' = 6 t^5 from 0 to h: both estimates are h^6 times a number of the table.
TEST(Dop853, ErrorNormCombinesBothEstimatesAsPublished) {
  const RightHandSide power{[](double t, const VectorX&, VectorX& rate) { rate[0] = 6 * t * t * t * t * t; }, nullptr,
                            0};
  const double timeStep = 0.7, tolerance = 1e-4, end = std::pow(timeStep, 6);
  Step step;
  dop853(power, VectorX::Zero(1), 0, timeStep, step);
  const auto estimate = [&](std::size_t row) {
    double sum = 0;
    for (std::size_t i = 0; i < dop853_table::kDerivatives; ++i)
      sum += dop853_table::kErrors[row][i] * 6 * std::pow(dop853_table::kNodes[i], 5);
    return sum * end / (tolerance * (1 + end));
  };
  const double fifth = estimate(0), third = estimate(1);
  // e5 is what sums of numbers of size 1 leave of 1e-5 or more: 11 digits.
  EXPECT_NEAR(dop853Error(step, VectorX::Constant(1, tolerance)) / (fifth * fifth / std::hypot(fifth, 0.1 * third)), 1,
              1e-10);
}

// The oscillator among others at rest: a mean over components would fall with their number.
TEST(Dop853, ErrorNormDoesNotAverageAStiffComponentAway) {
  const RightHandSide one = oscillator(3);
  const RightHandSide among{[=](double time, const VectorX& state, VectorX& rate) {
                              rate.setZero();
                              one.derivative(time, state, rate);
                            },
                            nullptr, 1};
  Step alone, crowd;
  VectorX start = VectorX::Zero(1000);
  start.head(2) = oscillatorAt(3, 0);
  dop853(one, start.head(2), 0, 0.3, alone);
  dop853(among, start, 0, 0.3, crowd);
  EXPECT_EQ(dop853Error(alone, VectorX::Constant(2, 1e-6)), dop853Error(crowd, VectorX::Constant(1000, 1e-6)));
}

TEST(Dop853, ErrorNormOfAStepOutOfTheFiniteNumbersIsNotANumber) {
  EXPECT_TRUE(std::isnan(dop853Error(stepOutOfFiniteNumbers(dop853), VectorX::Constant(2, 1e-6))));
}

// Two steps one after the other, with and without the rate at the point between: the same bits, one evaluation less.
TEST(Dop853, CarriesTheEndRateToTheNextStep) {
  int evaluations = 0;
  const RightHandSide counted{[&](double time, const VectorX& state, VectorX& rate) {
                                ++evaluations;
                                kepler().derivative(time, state, rate);
                              },
                              nullptr, 2};
  Step first, second;
  dop853(counted, keplerAt(0), 0, 0.5, first);
  dop853(counted, first.state, 0.5, 0.5, second);
  EXPECT_EQ(evaluations, 24);

  Step step;
  evaluations = 0;
  dop853(counted, keplerAt(0), 0, 0.5, step);
  prepareInterpolant(counted, step);
  EXPECT_EQ(evaluations, 16);
  carryEndDerivative(step);
  dop853(counted, first.state, 0.5, 0.5, step);
  EXPECT_EQ(evaluations, 27);
  EXPECT_EQ(step.state, second.state);

  keepStartDerivative(step);
  dop853(counted, first.state, 0.5, 0.5, step);
  EXPECT_EQ(evaluations, 38);
  EXPECT_EQ(step.state, second.state);
}

}  // namespace
}  // namespace cradle
