#include "study/stability/chains_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "study/sample_scenes.h"
#include "study/stability/contact_scenes.h"

namespace cradle {
namespace {

/// After 2 s: half a swing of the longest.
ChainOutcome outcomeOf(const char* method, double setting, int balls, double mass) {
  Scene scene = swingingChain(balls, mass);
  scene.duration = 2;
  return outcomeOf(StudyScene(std::move(scene)).run(methodOf(method), setting, 1));
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
  const double step = 1.0 / 60, limit = heaviestForRk4(2, step);
  EXPECT_EQ(outcomeOf("rk4", step, 2, 0.9 * limit), ChainOutcome::holds);
  EXPECT_EQ(outcomeOf("rk4", step, 2, 1.5 * limit), ChainOutcome::stopped);
  EXPECT_EQ(outcomeOf("rk4", step, 8, 1.5 * heaviestForRk4(8, step)), ChainOutcome::stopped);
}

TEST(Chains, HoldByThePlanAtAnyMass) {
  EXPECT_EQ(outcomeOf("plan", 1e-4, 3, 300), ChainOutcome::holds);
}

}  // namespace
}  // namespace cradle
