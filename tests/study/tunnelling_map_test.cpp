#include "study/stability/tunnelling_map.h"

#include <gtest/gtest.h>

#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/semi_implicit_euler.h"
#include "simulate/simulate.h"
#include "study/stability/contact_scenes.h"

namespace cradle {
namespace {

void twiceAsFar(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  semiImplicitEuler(rightHandSide, state, time, 2 * timeStep, step);
}

TEST(Tunnelling, BeginsWhereAStepLeadsPastTheMiddleOfThePlate) {
  for (const double thickness : {0.001, 0.05, 1.0})
    for (const Integrator integrate : {semiImplicitEuler, rk4}) {
      const double expected = (thickness / 2 + kMarbleRadius) * 60;
      EXPECT_NEAR(fastestStopped({thickness, 1.0 / 60, integrate}) / expected, 1, 1e-6) << thickness;
    }
}

TEST(Tunnelling, IsUnseenWhereAStepLeadsPastThePlate) {
  for (const double thickness : {0.001, 0.05, 1.0})
    EXPECT_NEAR(fastestSeen({thickness, 0.001, semiImplicitEuler}) / ((thickness + 2 * kMarbleRadius) * 1000), 1, 1e-6);
}

TEST(Tunnelling, BeginsAtHalfTheSpeedForAnIntegratorThatGoesTwiceAsFar) {
  const double right = fastestStopped({0.01, 1.0 / 60, semiImplicitEuler});
  EXPECT_NEAR(fastestStopped({0.01, 1.0 / 60, twiceAsFar}) / right, 0.5, 1e-6);
}

TEST(Tunnelling, NeverHappensWhereStepsEndAtImpacts) {
  for (const double speed : {1.0, 100.0, 10000.0})
    for (const MethodName name : {MethodName::semiImplicitEuler, MethodName::rk4, MethodName::dop853}) {
      Scene scene = marblesAtPlate(0.001, {{0.3 * speed / 60, speed}});
      scene.output.framesPerSecond = 1 / scene.duration;
      if (name != MethodName::dop853) scene.method = Method{name, 1.0 / 60, "test"};
      EXPECT_LT(simulate(scene).frames.back().states[0].position.x(), -0.5e-3 - kMarbleRadius) << speed;
    }
}

TEST(Tunnelling, IsTriedOnTheFastContactStepToo) {
  Scene scene = marblesAtPlate(0.001, std::vector<Throw>(60, {1e-9, 1}));
  scene.accuracy = 1e-3;
  const Plan plan = planOf(scene);
  ASSERT_EQ(plan.islands.size(), 1U);
  EXPECT_EQ(plan.islands[0].method.kind, MotionKind::pile);
}

}  // namespace
}  // namespace cradle
