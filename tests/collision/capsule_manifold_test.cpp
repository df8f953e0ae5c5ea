#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "collision/predicted_manifold.h"
#include "collision/random_poses.h"

namespace cradle {
namespace {

constexpr double kPatchRounding = 1e-13;  // m: rounding of coordinates below 1 m
constexpr double kBent = 1e-4;     // m: what ends of a line of contact may miss of the deepest place between them
constexpr double kMargin = 0.005;  // m
const Vec3 kStill = Vec3::Zero();

/// Least distance of the axes, less both radii, over points of A's axis and, by thirds, all of B's: convex in both.
double sampledGap(const PosedCapsule& a, const PosedCapsule& b) {
  const auto fromA = [&](double s) {
    const Vec3 onA = a.center + s * a.half;
    double from = -1, to = 1;
    for (int i = 0; i < 60; ++i) {
      const double low = from + (to - from) / 3, high = to - (to - from) / 3;
      const auto distance2 = [&](double t) { return (b.center + t * b.half - onA).squaredNorm(); };
      distance2(low) < distance2(high) ? to = high : from = low;
    }
    return (b.center + from * b.half - onA).norm();
  };
  double least = 1e9;
  for (int i = -200; i <= 200; ++i) least = std::min(least, fromA(i / 200.0));
  return least - a.radius - b.radius;
}

double deepestOf(const PredictedManifold& patch) {
  double least = 1e9;
  for (std::size_t k = 0; k < patch.count; ++k) least = std::min(least, patch.points[k].separation);
  return least;
}

/// m, of a point from a capsule's surface, < 0 inside.
double heightOver(const PosedCapsule& capsule, const Vec3& point) {
  const double part = (point - capsule.center).dot(capsule.half) / std::max(capsule.half.squaredNorm(), 1e-300);
  return (point - capsule.center - std::clamp(part, -1.0, 1.0) * capsule.half).norm() - capsule.radius;
}

// Steps of A's axis are 1 mm, so that the sampled gap is too large by at most 0.5 mm^2 / 0.05 m / 2 = 5e-6 m.
TEST(CapsulesInContact, AreAsDeepAsSampledAxes) {
  constexpr double kSampling = 5e-6;  // m
  RandomPoses random(7);
  int touching = 0, lines = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const Vec3 along = random.direction(), tilt = random.vector(1);
    const double bend = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 0.02 : 2;
    const double length = trial % 10 == 0 ? 0 : random.number(0.05, 0.2);
    const PosedCapsule a{random.vector(0.2), 0.2 * along, 0.06};
    const Vec3 beside = along.cross(random.direction()).normalized();
    const Vec3 shift = random.number(-0.3, 0.3) * along;
    const PosedCapsule b{a.center + 0.118 * beside + shift, length * (along + bend * tilt).normalized(), 0.06};
    const double gap = sampledGap(a, b);
    if (gap < -0.06) continue;  // so deep that the way out is not along the nearest points for certain
    const PredictedManifold patch = contactOfCapsules(a, b, kStill, kMargin);
    if (gap > kMargin + kSampling) {
      EXPECT_EQ(patch.count, 0u);
      EXPECT_LT(patch.clearance, gap + kPatchRounding);
      continue;
    }
    ++touching;
    ASSERT_GE(patch.count, 1u) << trial;
    EXPECT_LT(deepestOf(patch), gap + kBent + kPatchRounding);
    EXPECT_GT(deepestOf(patch), gap - kSampling);
    if (length == 0) {
      EXPECT_EQ(patch.count, 1u);
    }
    lines += patch.count >= 2;
  }
  EXPECT_GT(touching, 60);
  EXPECT_GT(lines, 20);
}

// 1 mm deep, the upper one 0.1 m farther along: they share from -0.1 to 0.2 m.
TEST(CapsulesInContact, HoldBothEndsOfWhatParallelOnesShare) {
  const PosedCapsule a{Vec3::Zero(), Vec3(0.2, 0, 0), 0.06}, b{Vec3(0.1, 0.119, 0), Vec3(-0.2, 0, 0), 0.06};
  const PredictedManifold patch = contactOfCapsules(a, b, kStill, kMargin);
  ASSERT_EQ(patch.count, 2u);
  EXPECT_LT((patch.normal - Vec3::UnitY()).norm(), kPatchRounding);
  EXPECT_LT((patch.points[0].onA - Vec3(-0.1, 0.06, 0)).norm(), kPatchRounding);
  EXPECT_LT((patch.points[1].onA - Vec3(0.2, 0.06, 0)).norm(), kPatchRounding);
  EXPECT_LT((patch.points[0].onB - Vec3(-0.1, 0.059, 0)).norm(), kPatchRounding);
  for (const std::size_t k : {0u, 1u}) EXPECT_NEAR(patch.points[k].separation, -0.001, kPatchRounding);
}

// Tilted by 1e-9 rad this way or that the nearest points are at one end or the other: both ends are held all the same.
TEST(CapsulesInContact, HoldTheSameEndsWhicheverIsNearer) {
  const PosedCapsule a{Vec3::Zero(), Vec3(0.2, 0, 0), 0.06};
  for (const double tilt : {-1e-9, 0.0, 1e-9})
    for (const double twist : {-1e-3, 0.0, 1e-3}) {
      const PosedCapsule b{Vec3(0.1, 0.119, 0), 0.2 * Vec3(1, tilt, twist), 0.06};
      const PredictedManifold patch = contactOfCapsules(a, b, kStill, kMargin);
      ASSERT_EQ(patch.count, 2u) << tilt << " " << twist;
      EXPECT_NEAR(patch.points[0].onA.x(), -0.1, 1e-6);
      EXPECT_NEAR(patch.points[1].onA.x(), 0.2, 1e-6);
    }
}

TEST(CapsulesInContact, TouchInOnePointCrossingAndEndToEnd) {
  const PosedCapsule a{Vec3::Zero(), Vec3(0.2, 0, 0), 0.06};
  const PredictedManifold crossing =
      contactOfCapsules(a, {Vec3(0.05, 0.118, 0.02), Vec3(0, 0, 0.2), 0.06}, kStill, kMargin);
  ASSERT_EQ(crossing.count, 1u);
  EXPECT_LT((crossing.normal - Vec3::UnitY()).norm(), kPatchRounding);
  EXPECT_LT((crossing.points[0].onA - Vec3(0.05, 0.06, 0)).norm(), kPatchRounding);
  EXPECT_NEAR(crossing.points[0].separation, -0.002, kPatchRounding);
  const PredictedManifold inLine = contactOfCapsules(a, {Vec3(0.517, 0, 0), Vec3(0.2, 0, 0), 0.06}, kStill, kMargin);
  ASSERT_EQ(inLine.count, 1u);
  EXPECT_LT((inLine.normal - Vec3::UnitX()).norm(), kPatchRounding);
  EXPECT_NEAR(inLine.points[0].separation, -0.003, kPatchRounding);
}

// Crossing at 0.02 rad: 0.2 m from the nearest place the axes are 4 mm aside, and the surfaces 0.07 mm farther apart.
// At 0.1 rad 20 mm and 1.6 mm: the nearest place is a point of its own.
TEST(CapsulesInContact, HoldTheNearestPlaceToo) {
  const PosedCapsule a{Vec3::Zero(), Vec3(0.2, 0, 0), 0.06};
  for (const double angle : {0.02, 0.1}) {
    const PosedCapsule b{Vec3(0, 0.12, 0), Vec3(0.2, 0, 0.2 * angle), 0.06};
    const PredictedManifold patch = contactOfCapsules(a, b, kStill, kMargin);
    ASSERT_EQ(patch.count, angle < 0.05 ? 2u : 3u);
    EXPECT_LT((patch.normal - Vec3::UnitY()).norm(), kPatchRounding);
    EXPECT_NEAR(deepestOf(patch), angle < 0.05 ? 6.6e-5 : 0, 1e-6);
  }
}

// One within the other: the axes meet, and the way out is across both.
TEST(CapsulesInContact, PartAcrossBothAxesWhereTheseMeet) {
  const PosedCapsule a{Vec3::Zero(), Vec3(0.2, 0, 0), 0.06};
  for (const Vec3& half : {Vec3(0.1, 0, 0), Vec3(0, 0, 0.1), Vec3(0, 0, 0)}) {
    const PredictedManifold patch = contactOfCapsules(a, {Vec3(0.02, 0, 0), half, 0.05}, kStill, kMargin);
    ASSERT_GE(patch.count, 1u);
    EXPECT_NEAR(patch.normal.dot(half), 0, kPatchRounding);
    EXPECT_NEAR(patch.normal.x(), 0, kPatchRounding);
    EXPECT_NEAR(deepestOf(patch), -0.11, kPatchRounding);
  }
}

// Falling past it, 0.3 m in the step, one meets it only if it comes nearer sideways too; where they meet is on both.
TEST(CapsulesInContact, AreThoseOfTheInstantAtWhichTheyWillMeet) {
  const PosedCapsule a{Vec3::Zero(), Vec3(0.2, 0, 0), 0.06}, b{Vec3(0.02, 0.2, 0.13), Vec3(0.1, 0, 0.001), 0.06};
  EXPECT_EQ(contactOfCapsules(a, b, Vec3(0, -0.3, 0), kMargin).count, 0u);
  const Vec3 motion(0, -0.2, -0.05);
  const PredictedManifold patch = contactOfCapsules(a, b, motion, kMargin);
  ASSERT_EQ(patch.count, 2u);
  for (const std::size_t k : {0u, 1u}) {
    const PredictedManifold::Point& point = patch.points[k];
    EXPECT_NEAR(heightOver(a, point.onA), 0, 1e-4);
    EXPECT_GT(point.separation, 0);
    EXPECT_LT(point.separation, -patch.normal.dot(motion));
    EXPECT_NEAR(heightOver(b, point.onB), 0, kMargin + 0.001);
  }
}

TEST(CapsuleOnPlane, LiesOnBothEndsAndStandsOnOne) {
  const PlaneCollider plane{Vec3::Zero(), Vec3::UnitY(), 0};
  const PredictedManifold lying =
      contactOfCapsuleAndPlane({Vec3(0, 0.061, 0), Vec3(0.2, 0, 0), 0.06}, plane, kStill, kMargin);
  ASSERT_EQ(lying.count, 2u);
  EXPECT_LT((lying.points[0].onB - Vec3(-0.2, 0, 0)).norm(), kPatchRounding);
  EXPECT_LT((lying.points[1].onA - Vec3(0.2, 0.001, 0)).norm(), kPatchRounding);
  const PredictedManifold standing =
      contactOfCapsuleAndPlane({Vec3(0, 0.259, 0), Vec3(0, 0.2, 0), 0.06}, plane, kStill, kMargin);
  ASSERT_EQ(standing.count, 1u);
  EXPECT_NEAR(standing.points[0].separation, -0.001, kPatchRounding);
  const PredictedManifold above =
      contactOfCapsuleAndPlane({Vec3(0, 0.3, 0), Vec3(0, 0.2, 0), 0.06}, plane, kStill, kMargin);
  EXPECT_EQ(above.count, 0u);
  EXPECT_NEAR(above.clearance, 0.04, kPatchRounding);
}

}  // namespace
}  // namespace cradle
