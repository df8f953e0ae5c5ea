#include "collision/hill_climbing.h"

#include <gtest/gtest.h>

#include "collision/gjk.h"
#include "collision/sample_cores.h"
#include "rounding.h"

namespace cradle {
namespace {

// Of the size: a gap is a difference of two support values, each some 16 rounded products and sums.
constexpr double kClimbRounding = 64 * kEpsilon;

// Cores that are apart have one maximum, their distance. GJK knows it to 1e-8 with rims, and less well where faces are
// nearly parallel; a climb from its normal, or from one a little aside, ends at it.
TEST(HillClimbing, EndsAtTheDistanceOfCoresApartAtAnySize) {
  for (const double size : {1.0, 1e-6, 1e6}) {
    RandomPoses random(2);
    forRandomCorePairs(size, 1, 8, [&](const CorePair& pair) {
      const GjkResult apart = distanceOf(pair.a, pair.b);
      if (apart.distance < 0.05 * size) return;
      for (const double aside : {0.0, 1e-3, 0.1}) {
        const Vec3 start = (apart.normal + aside * random.direction()).normalized();
        const SeparatingAxis top = climbedSupportGap({0, start}, pair.a, pair.b);
        EXPECT_LE(top.separation, apart.distance + kClimbRounding * size) << pair.name();
        // kRoundDistance with a rim, else exact.
        const double known = pair.isRound() ? 1e-8 * apart.distance : 0;
        EXPECT_GE(top.separation, apart.distance - known - kClimbRounding * size) << pair.name() << ' ' << aside;
        EXPECT_NEAR(pair.gapSeen(top.normal), top.separation, kClimbRounding * size) << pair.name();
      }
    });
  }
}

// A climb never ends lower than it began, and no direction near its end sees more: of steps s to all sides, the gap
// changes by s times the size at a ridge, and by s^2 on a smooth top, where rounding shows from s = 1e-7 on.
TEST(HillClimbing, EndsOnATopOfOverlappingCores) {
  RandomPoses random(4);
  forRandomCorePairs(1, 0.3, 6, [&](const CorePair& pair) {
    const Vec3 start = random.direction();
    const SeparatingAxis top = climbedSupportGap({0, start}, pair.a, pair.b);
    EXPECT_NEAR(top.normal.norm(), 1, 4 * kEpsilon);
    EXPECT_NEAR(pair.gapSeen(top.normal), top.separation, kClimbRounding) << pair.name();
    EXPECT_GE(top.separation, pair.gapSeen(start) - kClimbRounding) << pair.name();
    for (const double step : {1e-2, 1e-4, 1e-6})
      for (int i = 0; i < 12; ++i) {
        const Vec3 side = top.normal.cross(random.direction()).normalized();
        EXPECT_LE(pair.gapSeen((top.normal + step * side).normalized()), top.separation + kClimbRounding)
            << pair.name() << ' ' << step;
      }
  });
}

// The rim of a disc and a line: their common perpendicular in closed form. A line along x at a height y over a rim of
// radius r about y, beside the axis by z > r: the nearest point of the rim is straight at (0, 0, r).
TEST(HillClimbing, FindsTheNearestPointsOfRims) {
  const SampleCore disc = cylinderCore("disc", 0.5, 0.02), line = segmentCore(4), point = pointCore(0.1);
  const auto climb = [](const CorePair& pair, const Vec3& start) {
    return climbedSupportGap({0, start.normalized()}, pair.a, pair.b);
  };
  const Quat alongX = rotationAbout(Vec3::UnitZ(), M_PI / 2);
  const CorePair beside{disc, line, {}, {alongX, Vec3(0.3, 0.41, 0.8)}};  // 0.3 beside the rim, 0.4 above: 0.5 away
  const SeparatingAxis toLine = climb(beside, Vec3(0.2, 0.3, 1));
  EXPECT_NEAR(toLine.separation, 0.5, kClimbRounding);
  EXPECT_LT((toLine.normal - Vec3(0, 0.8, 0.6)).norm(), 1e-12);
  const SeparatingAxis toPoint = climb({disc, point, {}, {Quat::Identity(), Vec3(0.9, -0.31, 1.2)}}, Vec3(1, 0, 1));
  EXPECT_NEAR(toPoint.separation, std::hypot(1, 0.3), kClimbRounding);  // sqrt(0.9^2 + 1.2^2) = 1.5, less 0.5
  // Two rims across each other: one stands, its lowest point over the other's inside, whose face is nearest.
  const SeparatingAxis standing = climb({disc, disc, {}, {alongX, Vec3(0.1, 0.71, 0.2)}}, Vec3(0.1, 1, 0.1));
  EXPECT_NEAR(standing.separation, 0.2, kClimbRounding);
  EXPECT_LT((standing.normal - Vec3::UnitY()).norm(), 1e-12);
  // Rim beside rim in one plane.
  const SeparatingAxis level = climb({disc, disc, {}, {Quat::Identity(), Vec3(0.9, 0.03, 1.2)}}, Vec3(0.6, 0.2, 0.8));
  EXPECT_NEAR(level.separation, std::hypot(0.5, 0.01), kClimbRounding);
}

// From a direction aside, the features near it may not be those of the nearest points; a gap that is enough is not
// doubted.
TEST(HillClimbing, LeadsOnWhereNoFeatureNearTheStartDoes) {
  const SampleCore box = boxCore("box", Vec3(1, 0.6, 1.4)), drum = cylinderCore("drum", 0.5, 0.8);
  RandomPoses random(6);
  int lower = 0;
  for (int i = 0; i < 200; ++i) {
    const RigidTransform pose{random.turn(), 2.2 * random.direction()};
    const CorePair pair{box, drum, {}, pose};
    const GjkResult apart = distanceOf(pair.a, pair.b);
    const Vec3 start = (apart.normal + 0.1 * random.direction()).normalized();
    const SeparatingAxis top = climbedSupportGap({0, start}, pair.a, pair.b);
    EXPECT_NEAR(top.separation, apart.distance, 1e-8 * apart.distance + kClimbRounding);  // kRoundDistance
    const double enough = 0.9 * apart.distance;
    const double less = climbedSupportGap({0, start}, pair.a, pair.b, enough).separation;
    EXPECT_GE(less, enough);
    if (less < top.separation - 1e-6) ++lower;
  }
  EXPECT_GT(lower, 0);
}

// A unit vector across both to rounding, however small their angle is; of parallel ones there is none.
TEST(Across, NearlyParallelDirectionsIsAUnitVectorAcrossBoth) {
  RandomPoses random(8);
  for (const double angle : {1.0, 1e-3, 1e-8, 1e-12, 1e-13})
    for (int i = 0; i < 50; ++i) {
      const Vec3 one = random.direction(), axis = one.cross(random.direction()).normalized();
      const Vec3 other = std::cos(angle) * one + std::sin(angle) * axis.cross(one);
      const Vec3 found = across(one, other);
      EXPECT_NEAR(found.norm(), 1, 4 * kEpsilon);
      EXPECT_NEAR(found.dot(one), 0, 4 * kEpsilon);
      EXPECT_NEAR(found.dot(other), 0, 4 * kEpsilon);
      EXPECT_LT((found - axis).norm(), 8 * kEpsilon / angle);  // the angle itself is rounded
    }
  EXPECT_EQ(across(Vec3::UnitX(), Vec3::UnitX()), Vec3::Zero());
  EXPECT_EQ(across(Vec3::UnitX(), -Vec3::UnitX()), Vec3::Zero());
}

}  // namespace
}  // namespace cradle
