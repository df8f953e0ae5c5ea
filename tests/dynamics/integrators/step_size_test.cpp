#include "dynamics/integrators/step_size.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "dynamics/integrator_problems.h"
#include "dynamics/integrators/dop853.h"

namespace cradle {
namespace {

struct Outcome {
  VectorX end;
  int evaluations = 0, steps = 0, rejections = 0;
};

/// Integrates to the end with controlled steps, the last one cut to fit.
Outcome runControlled(const RightHandSide& problem, const VectorX& start, double duration, double tolerance) {
  Outcome run;
  const RightHandSide counted{[&](double time, const VectorX& state, VectorX& rate) {
                                ++run.evaluations;
                                problem.derivative(time, state, rate);
                              },
                              nullptr, 0};
  const VectorX tolerances = VectorX::Constant(start.size(), tolerance);
  Step step;
  beginStep(counted, start, 0, 0, step);
  StepSize size{firstTimeStep(counted, tolerances, step, 8)};
  double time = 0;
  run.end = start;
  while (time < duration) {
    const double taken = std::min(size.timeStep, duration - time);
    dop853(counted, run.end, time, taken, step);
    if (!acceptStep(dop853Error(step, tolerances), taken, size)) {
      ++run.rejections;
      keepStartDerivative(step);
      continue;
    }
    ++run.steps;
    time = taken < duration - time ? time + taken : duration;
    run.end = step.state;
  }
  return run;
}

// The flow of the oscillator with omega = 1 keeps distances: errors of steps add up at most. A component's error stays
// below tolerance x (1 + 1), and there are two components.
TEST(StepSize, OscillatorErrorIsAtMostTheSumOfTolerances) {
  for (int digits = 3; digits <= 12; ++digits) {
    const double tolerance = std::pow(10, -digits);
    const Outcome run = runControlled(oscillator(1), oscillatorAt(1, 0), 100, tolerance);
    EXPECT_LT((run.end - oscillatorAt(1, 100)).norm(), run.steps * tolerance * 2 * std::sqrt(2.0)) << tolerance;
    RecordProperty(("evaluations" + std::to_string(digits)).c_str(), run.evaluations);
  }
}

// On an ellipse an error d of the start changes the energy by up to |grad| d, |grad| = |(1/r^2, v)| = 2.45 at the
// nearest point, the mean motion by 3 times that, and by a time T later the place by v x that x T = 10 T d. Errors made
// all along the way count half.
TEST(StepSize, EllipseErrorIsWithinItsSensitivity) {
  const double duration = 20 * std::numbers::pi;
  for (int digits = 3; digits <= 12; ++digits) {
    const double tolerance = std::pow(10, -digits);
    const Outcome run = runControlled(kepler(), keplerAt(0), duration, tolerance);
    const double mostLocal = tolerance * (1 + 1.37) * 2;  // speed up to 1.37; four components
    EXPECT_LT((run.end - keplerAt(duration)).norm(), run.steps * mostLocal * 5 * duration) << tolerance;
    RecordProperty(("evaluations" + std::to_string(digits)).c_str(), run.evaluations);
  }
}

TEST(StepSize, GrowsAndShrinksWithTheEighthRootOfTheError) {
  StepSize size{0.5};
  EXPECT_TRUE(acceptStep(1.0 / 256, 0.5, size));  // (1/256)^(1/8) = 1/2
  EXPECT_DOUBLE_EQ(size.timeStep, 0.5 * 0.9 * 2);
  EXPECT_FALSE(acceptStep(25.62890625, 0.9, size));  // 1.5^8
  EXPECT_DOUBLE_EQ(size.timeStep, 0.9 * 0.9 / 1.5);
}

TEST(StepSize, OfOrderFiveGoesWithTheFifthRootOfTheError) {
  StepSize size{0.5, 5};
  EXPECT_TRUE(acceptStep(1.0 / 32, 0.5, size));  // (1/32)^(1/5) = 1/2
  EXPECT_DOUBLE_EQ(size.timeStep, 0.5 * 0.9 * 2);
  EXPECT_TRUE(acceptStep(0, 0.5, size));
  EXPECT_FALSE(acceptStep(7.59375, 0.9, size));  // 1.5^5
  EXPECT_DOUBLE_EQ(size.timeStep, 0.9 * 0.9 / 1.5);
}

TEST(StepSize, ChangesByNoMoreThanAThirdAndSix) {
  for (const int order : {5, 8}) {
    StepSize size{1, order};
    EXPECT_TRUE(acceptStep(0, 1, size));
    EXPECT_EQ(size.timeStep, 6) << order;
    EXPECT_FALSE(acceptStep(1e30, 6, size));
    EXPECT_DOUBLE_EQ(size.timeStep, 2) << order;
  }
}

TEST(StepSize, DoesNotGrowRightAfterARejection) {
  StepSize size{1};
  EXPECT_FALSE(acceptStep(1e30, 1, size));
  const double tried = size.timeStep;
  EXPECT_TRUE(acceptStep(1e-6, tried, size));
  EXPECT_EQ(size.timeStep, tried);
  EXPECT_TRUE(acceptStep(1.0 / 256, tried, size));
  EXPECT_GT(size.timeStep, tried);
}

TEST(StepSize, RejectsWhatIsNotFinite) {
  for (const double norm : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    StepSize size{0.3};
    EXPECT_FALSE(acceptStep(norm, 0.3, size));
    EXPECT_DOUBLE_EQ(size.timeStep, 0.1);
  }
}

TEST(StepSize, KeepsThePlanAfterAStepThatAnEventCutShort) {
  StepSize size{1};
  EXPECT_TRUE(acceptStep(1e-30, 0.01, size));
  EXPECT_EQ(size.timeStep, 1);
}

// A first step that is far too long is rejected, one far too short wasted: the error norm of a good one is in between.
TEST(StepSize, FirstTimeStepFitsTheTolerance) {
  for (const double tolerance : {1e-4, 1e-7, 1e-10}) {
    const VectorX tolerances = VectorX::Constant(4, tolerance);
    Step step;
    beginStep(kepler(), keplerAt(0), 0, 0, step);
    const double first = firstTimeStep(kepler(), tolerances, step, 8);
    dop853(kepler(), keplerAt(0), 0, first, step);
    EXPECT_LT(dop853Error(step, tolerances), 1) << tolerance;
    dop853(kepler(), keplerAt(0), 0, 20 * first, step);
    EXPECT_GT(dop853Error(step, tolerances), 1) << tolerance;
  }
}

// Nothing moves and nothing pulls: the first guess and what it grows to are finite.
TEST(StepSize, FirstTimeStepOfAStateAtRestIsFinite) {
  const RightHandSide rest{[](double, const VectorX&, VectorX& rate) { rate.setZero(); }, nullptr, 0};
  const VectorX tolerances = VectorX::Constant(2, 1e-6);
  Step step;
  beginStep(rest, VectorX::Zero(2), 0, 0, step);
  const double first = firstTimeStep(rest, tolerances, step, 8);
  EXPECT_GT(first, 0);
  EXPECT_LT(first, 1e-3);
}

}  // namespace
}  // namespace cradle
