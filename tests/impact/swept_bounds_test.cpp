#include "impact/swept_bounds.h"

#include <gtest/gtest.h>

#include <random>

namespace cradle {
namespace {

constexpr double kMargin = 0.005, kTimeStep = 1.0 / 60;  // m, s: of the whole step
constexpr int kPieces = 4;

class Random {
 public:
  double number(double from, double to) { return std::uniform_real_distribution<double>(from, to)(engine_); }
  Vec3 vector(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach)}; }

 private:
  std::mt19937 engine_{5};
};

MovingPose randomPose(Random& random) {
  MovingPose pose;
  pose.radius = 0.1;
  pose.boxCenter = random.vector(0.4);
  pose.boxHalf = Vec3::Constant(0.06) + 0.02 * random.vector(1).cwiseAbs();
  pose.linearVelocity = random.vector(8);
  pose.spinSpeed = random.number(0, 1);
  return pose;
}

/// A piece later, with a velocity a little different, as contact may leave it.
void moveOn(MovingPose& pose, Random& random) {
  pose.boxCenter += kTimeStep / kPieces * pose.linearVelocity;
  pose.linearVelocity += random.vector(0.4);
  pose.boxHalf += 1e-4 * random.vector(1);
}

/// Whether contacts would look at the pair: nearer than the margin and what both can move until the next look.
bool isLookedAt(const MovingPose& a, const MovingPose& b) {
  const double speed = (b.linearVelocity - a.linearVelocity).lpNorm<1>() + a.spinSpeed + b.spinSpeed;
  const double gap = ((b.boxCenter - a.boxCenter).cwiseAbs() - a.boxHalf - b.boxHalf).maxCoeff();
  return gap < kMargin + speed * kTimeStep / kPieces;
}

// The pairs passed over are some of those that are never looked at, and most of them; all others must be told.
TEST(SweptBounds, PassOverOnlyPairsThatAreNotLookedAtUntilTheStepEnds) {
  Random random;
  WorkerThreads threads(1);
  int passed = 0, never = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<MovingPose> poses{randomPose(random), randomPose(random)};
    const VectorX unused;
    SweptBounds courses;
    bool mayMeet = true, isEverLookedAt = false;
    for (int piece = 0; piece < kPieces; ++piece) {
      const SoftStepStart look{poses, unused, kTimeStep / kPieces, kMargin, (kPieces - piece) * kTimeStep / kPieces};
      courses.renew(look, threads);
      if (courses.areRenewed(0, 1)) mayMeet = courses.mayMeet(0, 1, look);
      const bool isNow = isLookedAt(poses[0], poses[1]);
      ASSERT_TRUE(mayMeet || !isNow) << trial << " " << piece;
      isEverLookedAt = isEverLookedAt || isNow;
      for (MovingPose& pose : poses) moveOn(pose, random);
    }
    passed += !mayMeet, never += !isEverLookedAt;
  }
  EXPECT_GT(passed, 0.7 * never);
  EXPECT_GT(never, 2000);
  EXPECT_LT(never, 18000);
}

// A body that leaves its course gets another one: 2 m/s and 8 mm beside 5 mm that are let pass.
TEST(SweptBounds, AreNewForWhatIsDeflected) {
  WorkerThreads threads(1);
  std::vector<MovingPose> poses(2);
  for (MovingPose& pose : poses) pose.radius = 0.1, pose.boxHalf = Vec3::Constant(0.1);
  poses[1].boxCenter.x() = 0.3;
  const VectorX unused;
  SweptBounds courses;
  const SoftStepStart first{poses, unused, kTimeStep / 2, kMargin, kTimeStep},
      second{poses, unused, kTimeStep / 2, kMargin, kTimeStep / 2};
  EXPECT_TRUE(courses.areForgotten());
  courses.renew(first, threads);
  EXPECT_TRUE(courses.areRenewed(0, 0));
  EXPECT_FALSE(courses.mayMeet(0, 1, first));
  courses.renew(second, threads);
  EXPECT_FALSE(courses.areRenewed(0, 1));
  poses[1].linearVelocity.x() = -2;
  courses.renew(second, threads);
  EXPECT_FALSE(courses.areRenewed(0, 0));
  EXPECT_TRUE(courses.areRenewed(0, 1));
  poses[0].boxCenter.y() += 0.008;
  courses.renew(second, threads);
  EXPECT_TRUE(courses.areRenewed(0, 0));
}

}  // namespace
}  // namespace cradle
