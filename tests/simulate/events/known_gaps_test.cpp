#include "simulate/events/known_gaps.h"

#include <gtest/gtest.h>

#include "simulate/one_island.h"

namespace cradle {
namespace {

constexpr double kLargestError = 1e-14;  // m

/// A ball that an impact with the floor has just left with some velocity (m/s).
struct StruckBall : OneIsland {
  explicit StruckBall(const Vec3& velocity)
      : OneIsland(R"("duration": 1, "gravity": [0, -9.81, 0], "bodies": [
          {"name": "floor", "shape": {"plane": {}}, "motion": "static"},
          {"name": "ball", "shape": {"sphere": {"radius": 0.05}}, "mass": 1, "position": [0, 0.05, 0]}])"),
        tolerances(eventTolerancesOf(eventScalesOf(island))),
        gaps(island, tolerances) {
    linearVelocity(island.state, 0) = Vec3(velocity.x(), -1, velocity.z());
    SequenceLimits limits;
    limits.gapErrors = {1e-13}, limits.reach = 1e-9, limits.duration = 1e-9;
    ImpactSequence sequence({contact()}, std::nullopt, island.assembly.radii, limits, island.state);
    EXPECT_TRUE(sequence.next(island.state));
    linearVelocity(island.state, 0) = velocity;
    sequence.finishImpact(island.state);
    gaps.keep(sequence, kLargestError);
  }

  Contact contact() {
    const std::vector<Contact> contacts = contactsWithin(0.01);
    EXPECT_EQ(contacts.size(), 1u);
    return contacts.at(0);
  }

  EventTolerances tolerances;
  KnownGaps gaps;
};

TEST(KnownGaps, GrowBySpeedTimesTime) {
  StruckBall ball({0.5, 0.5, 0});
  ball.island.time += 1e-9;
  const auto gap = ball.gaps.find(ball.contact(), kLargestError);
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->gap, 5e-10, 1e-24);
  // (5e-10)^2 / 0.05 for the way, and the rounding of a time of 1e-9 s.
  EXPECT_NEAR(gap->error, 5e-18, 1e-24);
}

TEST(KnownGaps, AreKnownNoLongerThanTheirSpeed) {
  StruckBall ball({0, 0.5, 0});
  ball.island.time += 1e-9;
  linearVelocity(ball.island.state, 0).y() -= 9e-6;  // 9e-15 m
  EXPECT_TRUE(ball.gaps.find(ball.contact(), kLargestError));
  linearVelocity(ball.island.state, 0).y() -= 2e-6;
  EXPECT_FALSE(ball.gaps.find(ball.contact(), kLargestError));
}

TEST(KnownGaps, AreNotKnownOnceBodiesHaveGoneFar) {
  StruckBall ball({3, 0.5, 0});
  ball.island.time += 1e-8;  // (3e-8)^2 / 0.05 = 1.8e-14 m
  EXPECT_FALSE(ball.gaps.find(ball.contact(), kLargestError));
}

TEST(KnownGaps, ABallThatHardlyOpensHasNone) {
  StruckBall ball({0, 1e-9, 0});
  ball.island.time += 1e-9;
  const auto gap = ball.gaps.find(ball.contact(), kLargestError);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->gap, 0);
}

}  // namespace
}  // namespace cradle
