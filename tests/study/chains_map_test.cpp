#include "study/stability/chains_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "study/sample_scenes.h"
#include "study/stability/contact_scenes.h"

namespace cradle {
namespace {

ChainOutcome outcomeOf(const char* method, double setting, int balls, double mass) {
  return outcomeOf(StudyScene(swingingChain(balls, mass)).run(methodOf(method), setting, 1));
}

// One ball between the world and the heavy one: it is pulled by both rods, w^2 = (T1 + T2) / m to some 1/M; the pull is
// 3 - 2 cos 30 degrees of the weight.
TEST(Chains, OfTwoBallsSwingAcrossAsTheHeavyOnePulls) {
  const double step = 1.0 / 60, pull = (3 - 2 * std::cos(std::acos(-1) / 6)) * 9.81;
  EXPECT_NEAR(heaviestForRk4(2, step) / (8 / (step * step) / (2 * pull)), 1, 2e-3);
}

// The pull is the strongest only at the bottom of the way, so that what is not far beyond the limit grows for a moment
// and does not blow up.
TEST(Chains, HoldByRk4UpToTheFastestSwingAcross) {
  for (const int balls : {2, 8}) {
    const double limit = heaviestForRk4(balls, 1.0 / 60);
    EXPECT_EQ(outcomeOf("rk4", 1.0 / 60, balls, 0.9 * limit), ChainOutcome::holds) << balls;
    EXPECT_EQ(outcomeOf("rk4", 1.0 / 60, balls, 1.5 * limit), ChainOutcome::stopped) << balls;
    EXPECT_EQ(outcomeOf("rk4", 1.0 / 120, balls, 1.5 * limit), ChainOutcome::holds) << balls;
  }
}

TEST(Chains, HoldByThePlanAtAnyMass) {
  EXPECT_EQ(outcomeOf("plan", 1e-6, 4, 3000), ChainOutcome::holds);
}

}  // namespace
}  // namespace cradle
