#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/integrators/explicit_euler.h"
#include "study/stability/bounce_energy_map.h"
#include "study/stability/coming_to_rest_map.h"
#include "study/stability/contact_scenes.h"
#include "study/stability/discrete_collisions.h"

namespace cradle {
namespace {

const BounceMethod& bounceMethod(MethodName name) {
  for (const BounceMethod& method : bounceMethods())
    if (method.name == name) return method;
  throw std::logic_error("no such method");
}

// Without loss the depth of an impact does not count. Next order: s h / (4 H) = g h / s of the change for each bounce,
// 0.05 % x 5.
TEST(BounceEnergy, OfElasticBouncesIsWhatEulersOwnEnergyLosesOrGains) {
  const double step = 2e-4;
  for (const MethodName name : {MethodName::explicitEuler, MethodName::semiImplicitEuler}) {
    const double expected = expectedHeightError(bounceMethod(name), 1, step);
    EXPECT_GT(std::abs(expected), 5 * step);
    EXPECT_NEAR(meanHeightError(bounceMethod(name), 1, step, 1) / expected, 1, 0.01);
  }
}

TEST(BounceEnergy, OfElasticBouncesIsKeptByRk4) {
  // 1600 steps a bounce, rounding of each 1e-16 of 1 m.
  EXPECT_NEAR(meanHeightError(bounceMethod(MethodName::rk4), 1, 1e-3, 1), 0, 1e-11);
}

// One bounce, with the depth d and the speed s that it had: H e^2 - (1 - e^2) d + a s h e (1 + e), and a little at both
// tops of the discrete parabola, g h^2 / 8 at the most.
TEST(BounceEnergy, DependsOnTheDepthOfTheImpact) {
  const double e = 0.8, height = 1, step = 1e-3;
  for (const BounceMethod& method : bounceMethods()) {
    DiscreteCollisions run(bouncingBall(e, height, 2), method.integrate, step);
    while (run.bounces() == 0) run.step();
    const double depth = 0.1 - centerOfMass(run.state(), 0).y(), speed = linearVelocity(run.state(), 0).y() / e;
    double highest = -1;
    for (; run.time() < 0.45 + 0.4; run.step()) highest = std::max(highest, centerOfMass(run.state(), 0).y() - 0.1);
    const double kept = method.heightChange(1) / 2;  // a
    const double expected = e * e * height - (1 - e * e) * depth + kept * speed * step * e * (1 + e);
    EXPECT_NEAR(highest, expected, 9.81 * step * step / 2) << method.title;
  }
}

// Depths of impacts are spread evenly over steps only about: 16 drops leave some per cent of their effect.
TEST(BounceEnergy, WithLossIsWhatTheMeanDepthTakes) {
  const double step = 1e-3;
  for (const BounceMethod& method : bounceMethods())
    EXPECT_NEAR(meanHeightError(method, 0.8, step, 16) / expectedHeightError(method, 0.8, step), 1, 0.05)
        << method.title;
}

TEST(BounceEnergy, MovesWithAnIntegratorThatIsAnother) {
  BounceMethod wrong = bounceMethod(MethodName::semiImplicitEuler);
  wrong.integrate = explicitEuler;
  EXPECT_LT(meanHeightError(wrong, 1, 1e-3, 1) / expectedHeightError(wrong, 1, 1e-3), -0.9);
}

TEST(BounceEnergy, IsRightAtAnyStepThatEndsAtImpacts) {
  for (const double e : {1.0, 0.6}) {
    EXPECT_NEAR(heightErrorWithEvents(e, {}), 0, 1e-9);
    for (const double step : {1e-3, 1e-2})
      EXPECT_NEAR(heightErrorWithEvents(e, Method{MethodName::rk4, step, "test"}), 0, 1e-9) << step;
  }
}

TEST(ComingToRest, ByEventsIsAtTheZenoTime) {
  EXPECT_NEAR(zenoTime(0.8), 4.0637127688715781401, 1e-14);  // references.json R6a
  for (const double e : {0.1, 0.5, 0.8}) EXPECT_NEAR(measuredRestTime(e, {}) / zenoTime(e), 1, 1e-9) << e;
}

// What is not resolved: rebounds of less than about two steps, 4 h / (1 - e) or less, and some steps.
TEST(ComingToRest, ByStepsIsEarlyByWhatTheyDoNotResolve) {
  for (const double e : {0.5, 0.8}) {
    const double step = 1.0 / 960;
    const double early = zenoTime(e) - measuredRestTime(e, Method{MethodName::rk4, step, "test"});
    EXPECT_GT(early, 0) << e;
    EXPECT_LT(early, 4 * step / (1 - e) + 4 * step) << e;
  }
}

TEST(ComingToRest, OfTextbookCollisionsEndsInTheGround) {
  const TextbookRest coarse = textbookRest(0.5, 1.0 / 60), fine = textbookRest(0.5, 1.0 / 240);
  EXPECT_GT(coarse.depth, fine.depth);
  EXPECT_GT(fine.depth, 0.001);
}

// Some sixty bounces, each at a depth of its own: in the mean they take what theory says.
TEST(ComingToRest, OfTextbookCollisionsIsEarlyByWhatBouncesLose) {
  for (const double step : {1.0 / 240, 1.0 / 960}) {
    const double expected = expectedTextbookRestTime(0.95, step);
    EXPECT_LT(expected, 0.9 * zenoTime(0.95));
    EXPECT_NEAR(textbookRest(0.95, step).time / expected, 1, 0.02) << step;
  }
}

}  // namespace
}  // namespace cradle
