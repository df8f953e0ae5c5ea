#include "study/stability/chains_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "study/sample_scenes.h"
#include "study/stability/contact_scenes.h"

namespace cradle {
namespace {

/// After 2 s: half a swing of the longest.
ChainOutcome chainOutcome(const char* method, double setting, int balls, double mass) {
  Scene scene = swingingChain(balls, mass);
  scene.duration = 2;
  return outcomeOf(StudyScene(std::move(scene)).run(methodOf(method), setting, 1));
}

// One ball between the world and the heavy one, M: both rods pull it, w^2 = (T1 + T2) / m, and 1/2 p g / m more since
// the heavy one gives way; T1 = p g (M + m), T2 = p g M, p = 3 - 2 cos 30 degrees. What is left is 1/M^2 of it.
TEST(Chains, OfTwoBallsSwingAcrossAsTheHeavyOnePulls) {
  const double step = 1.0 / 60, pull = (3 - std::sqrt(3)) * 9.81;
  EXPECT_NEAR(heaviestForRk4(2, step) / ((8 / (step * step * pull) - 1.5) / 2), 1, 1e-5);
}

// The pull is the strongest only at the bottom of the way, so that what is not far beyond the limit grows for a moment
// and does not blow up.
TEST(Chains, HoldByRk4UpToTheFastestSwingAcross) {
  const double step = 1.0 / 60, limit = heaviestForRk4(2, step);
  EXPECT_EQ(chainOutcome("rk4", step, 2, 0.9 * limit), ChainOutcome::holds);
  EXPECT_EQ(chainOutcome("rk4", step, 2, 1.5 * limit), ChainOutcome::stopped);
  EXPECT_EQ(chainOutcome("rk4", step, 8, 1.5 * heaviestForRk4(8, step)), ChainOutcome::stopped);
}

TEST(Chains, HoldByThePlanAtAnyMass) {
  EXPECT_EQ(chainOutcome("plan", 1e-4, 3, 300), ChainOutcome::holds);
}

}  // namespace
}  // namespace cradle
