#include "dynamics/integrators/step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/integrator_problems.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/dormand_prince5.h"
#include "dynamics/integrators/rk4.h"

namespace cradle {
namespace {

TEST(Interpolant, IsExactForCubicsAndAtBothEnds) {
  const auto cubic = [](double t) { return 1 + 2 * t - 3 * t * t + 4 * t * t * t; };
  const RightHandSide rate{[](double t, const VectorX&, VectorX& r) { r[0] = 2 - 6 * t + 12 * t * t; }, nullptr, 0};
  Step step;
  rk4(rate, VectorX::Constant(1, cubic(0.5)), 0.5, 2, step);
  prepareInterpolant(rate, step);
  VectorX state;
  for (const double fraction : {0.0, 0.1, 0.37, 0.5, 0.9, 1.0}) {
    interpolate(step, fraction, state);
    EXPECT_NEAR(state[0], cubic(0.5 + 2 * fraction), 1e-13 * cubic(2.5)) << fraction;
  }
}

/// A step of three components whose corrections are made up.
Step madeUpStep(InterpolantKind kind) {
  Step step;
  step.time = 1, step.timeStep = 0.4;
  step.startState = Vec3(1, -2, 0.5), step.state = Vec3(0.7, 3, -1);
  step.startDerivative = Vec3(2, 1, -3), step.endDerivative = Vec3(-1, 4, 0.5);
  step.corrections = {Vec3(0.3, -1, 2), Vec3(1, 0.2, -0.7), Vec3(-2, 0.4, 0.1), Vec3(0.6, 1.5, -0.9)};
  step.interpolant = kind;
  step.hasEndDerivative = step.hasCorrections = true;
  return step;
}

// In powers of s: Hermite's cubic with 3 s^2 - 2 s^3 of the way, (s - 2 s^2 + s^3) h of the derivative at the start and
// (s^3 - s^2) h of that at the end; and s^2 (1 - s)^2 (c0 + s c1 + s (1 - s) c2 + s^2 (1 - s) c3), of the degree 4 c0
// alone.
TEST(Interpolant, HasTheCorrectionsOfItsDegree) {
  for (const InterpolantKind kind :
       {InterpolantKind::cubicHermite, InterpolantKind::degreeFour, InterpolantKind::degreeSeven}) {
    const Step step = madeUpStep(kind);
    VectorX state;
    for (const double s : {0.0, 0.2, 0.5, 0.7, 1.0}) {
      VectorX expected = step.startState + (3 * s * s - 2 * s * s * s) * (step.state - step.startState) +
                         0.4 * (s - 2 * s * s + s * s * s) * step.startDerivative +
                         0.4 * (s * s * s - s * s) * step.endDerivative;
      const double bump = s * s * (1 - s) * (1 - s);
      if (kind != InterpolantKind::cubicHermite) expected += bump * step.corrections[0];
      if (kind == InterpolantKind::degreeSeven)
        expected += bump * (s * step.corrections[1] + s * (1 - s) * step.corrections[2] +
                            s * s * (1 - s) * step.corrections[3]);
      interpolate(step, s, state);
      EXPECT_LT((state - expected).norm(), 1e-14) << s;  // of some ten terms below 10
    }
  }
}

// Both are polynomials of degree 4 with the same values: the same to rounding.
TEST(Step, WhatIsCutOffAStepLeavesTheRestOfItsCurve) {
  const double timeStep = 0.8, cut = 0.3;
  const Step whole = keplerStep(dormandPrince5, 0.4, timeStep);
  Step part = whole;
  cutStep(cut, part);
  EXPECT_DOUBLE_EQ(part.timeStep, cut * timeStep);
  VectorX state, of;
  for (const double fraction : {0.0, 0.2, 0.5, 0.9, 1.0}) {
    interpolate(part, fraction, of);
    interpolate(whole, fraction * cut, state);
    EXPECT_LT((of - state).norm(), 1e-15) << fraction;
  }
  const double delta = 1e-6;  // of the step: the difference is good to delta^2 and to rounding over delta
  VectorX before, after;
  interpolate(whole, cut - delta, before);
  interpolate(whole, cut + delta, after);
  EXPECT_LT(((after - before) / (2 * delta * timeStep) - part.endDerivative).norm(), 1e-9);
}

/// y' = t, which notes when it was asked.
struct CountedClock {
  std::vector<double> times;
  RightHandSide rightHandSide{[this](double time, const VectorX&, VectorX& rate) {
                                times.push_back(time);
                                rate[0] = time;
                              },
                              nullptr, 0};
};

TEST(Step, AsksForADerivativeAtItsStartUnlessItIsKnown) {
  CountedClock clock;
  Step step;
  const VectorX state = VectorX::Constant(1, 5);
  beginStep(clock.rightHandSide, state, 2, 0.5, step);
  EXPECT_EQ(clock.times, std::vector<double>({2}));
  EXPECT_EQ(step.startDerivative[0], 2);
  EXPECT_EQ(step.startState, state);
  keepStartDerivative(step);
  beginStep(clock.rightHandSide, state, 2, 0.25, step);  // the same step, shorter
  EXPECT_EQ(clock.times.size(), 1u);
  EXPECT_EQ(step.timeStep, 0.25);
  beginStep(clock.rightHandSide, state, 2, 0.25, step);  // kept for one step alone
  EXPECT_EQ(clock.times.size(), 2u);
}

TEST(Step, CarriesADerivativeAtItsEndIfItHasOne) {
  CountedClock clock;
  Step step;
  step.state = VectorX::Constant(1, 6);
  beginStep(clock.rightHandSide, step.state, 2, 0.5, step);
  carryEndDerivative(step);
  beginStep(clock.rightHandSide, step.state, 2.5, 0.5, step);
  EXPECT_EQ(clock.times, std::vector<double>({2, 2.5}));
  prepareInterpolant(clock.rightHandSide, step);
  prepareInterpolant(clock.rightHandSide, step);  // it is there
  EXPECT_EQ(clock.times, std::vector<double>({2, 2.5, 3}));
  EXPECT_EQ(step.endDerivative[0], 3);
  carryEndDerivative(step);
  EXPECT_FALSE(step.hasEndDerivative);
  beginStep(clock.rightHandSide, step.state, 3, 0.5, step);
  EXPECT_EQ(clock.times.size(), 3u);
  EXPECT_EQ(step.startDerivative[0], 3);
}

// Central differences over d = 1e-4 miss a derivative by d^2 / 6 of the third one, some 1e-7 here, and by rounding / d.
TEST(Step, RateOfItsInterpolantIsTheDerivativeOfItsStates) {
  // x'' = 9.81 - 9 x, as (x, v).
  const RightHandSide rightHandSide{
      [](double, const VectorX& state, VectorX& rate) { rate[0] = state[1], rate[1] = 9.81 - 9 * state[0]; }, nullptr,
      1};
  for (const Integrator integrate : {rk4, dormandPrince5, dop853}) {
    Step step;
    integrate(rightHandSide, Eigen::Vector2d(1, 2), 0, 0.5, step);
    prepareInterpolant(rightHandSide, step);
    VectorX rate, before, after;
    for (const double fraction : {0.1, 0.37, 0.5, 0.9}) {
      interpolateRate(step, fraction, rate);
      interpolate(step, fraction - 1e-4, before);
      interpolate(step, fraction + 1e-4, after);
      EXPECT_LT((rate - (after - before) / (2e-4 * step.timeStep)).norm(), 1e-6) << fraction;
    }
    interpolateRate(step, 0, rate);
    EXPECT_LT((rate - step.startDerivative).norm(), 1e-13);
    interpolateRate(step, 1, rate);
    EXPECT_LT((rate - step.endDerivative).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace cradle
