#include "collision/gjk.h"

#include <gtest/gtest.h>

#include "collision/sample_cores.h"
#include "collision/widest_gap.h"
#include "rounding.h"

// A distance is proven, not compared: two points of the cores that are as far apart bound it from above, the gap that
// a unit normal sees between their support values from below.

namespace cradle {
namespace {

// Of the largest coordinate: a point is some 16 rounded products and sums (the matrix of a quaternion, a turn, a
// shift), and what is compared has four of them.
constexpr double kGjkRounding = 32 * kEpsilon;

/// `extent` (m): the largest coordinate.
void expectProvenDistance(const CorePair& pair, const GjkResult& found, double extent) {
  const double rounding = kGjkRounding * extent;
  EXPECT_NEAR(found.normal.norm(), 1, 4 * kEpsilon) << pair.name();
  EXPECT_NEAR((found.onB - found.onA).norm(), found.distance, rounding) << pair.name();
  EXPECT_LT((found.onB - found.onA - found.distance * found.normal).norm(), rounding) << pair.name();
  EXPECT_LE(pair.sampleA.outside(pair.poseA.inverse() * found.onA), rounding) << pair.name();
  EXPECT_LE(pair.sampleB.outside(pair.poseB.inverse() * found.onB), rounding) << pair.name();
  EXPECT_NEAR(pair.gapSeen(found.normal), found.lowerBound, rounding) << pair.name();
  // A normal n between points whose difference d is rounded by e has an angle of e / d, and sees a gap that is less by
  // that angle times the width across n, a size at most. With a rim it may be worse: the distance is then the largest
  // gap near the normal, to 1e-6, by a search that knows nothing of cores.
  const double rounded = found.distance - rounding * (1 + extent / found.distance);
  EXPECT_TRUE(pair.isRound() || found.lowerBound >= rounded) << pair.name() << found.distance - found.lowerBound;
  if (!pair.isRound() || found.lowerBound >= (1 - 1e-6) * found.distance) return;
  const auto gapSeen = [&](const Vec3& direction) { return pair.gapSeen(direction); };
  EXPECT_GE(gapSeen(climbed(gapSeen, found.normal, 1e-7)), (1 - 1e-6) * found.distance) << pair.name();
}

TEST(Gjk, NearestPointsAndNormalProveTheDistanceAtAnySize) {
  for (const double size : {1.0, 1e-6, 1e6}) {
    int apart = 0;
    forRandomCorePairs(size, 1, 30, [&](const CorePair& pair) {
      const GjkResult found = distanceOf(pair.a, pair.b);
      if (found.distance > 0.01 * size) ++apart, expectProvenDistance(pair, found, 2 * size);
    });
    EXPECT_GT(apart, 500);
  }
}

// A point inside both is a proof of overlap.
TEST(Gjk, CoresWithACommonInnerPointHaveNoDistance) {
  const std::vector<SampleCore> cores = sampleCores(1);
  RandomPoses random(3);
  for (const SampleCore& a : cores)
    for (const SampleCore& b : cores) {
      if (a.outside(Vec3::Zero()) >= 0 || b.outside(Vec3::Zero()) >= 0) continue;  // nothing is inside a segment
      for (int i = 0; i < 30; ++i) {
        const RigidTransform poseA = random.pose(1);
        const Quat turn = random.turn();
        // Both origins are inside. From A's origin to a place shortly before its surface, and the same of B.
        const auto innerPoint = [&](const SampleCore& core) {
          const Vec3 way = random.direction();
          double part = 0.9;
          while (core.outside(part * way) > -1e-6) part *= 0.9;
          return Vec3(part * way);
        };
        const Vec3 ofA = poseA * innerPoint(a), ofB = turn * innerPoint(b);
        const CorePair pair{a, b, poseA, {turn, ofA - ofB}};
        const GjkResult found = distanceOf(pair.a, pair.b);
        EXPECT_EQ(found.distance, 0) << pair.name();
        EXPECT_EQ(found.normal, Vec3::Zero()) << pair.name();
      }
    }
}

TEST(Gjk, DistancesOfFeaturesAreTheirClosedForms) {
  const SampleCore point = pointCore(0.1), segment = segmentCore(2), box = boxCore("box", Vec3(2, 4, 6));
  const Quat straight = Quat::Identity(), alongX = rotationAbout(Vec3::UnitZ(), M_PI / 2);
  const auto distance = [&](const SampleCore& a, const SampleCore& b, const Quat& turn, const Vec3& place) {
    const CorePair pair{a, b, {}, {turn, place}};
    return distanceOf(pair.a, pair.b).distance;
  };
  EXPECT_NEAR(distance(point, point, straight, Vec3(2, 3, 6)), 7, kGjkRounding * 7);
  EXPECT_NEAR(distance(point, segment, straight, Vec3(3, 0.7, 4)), 5, kGjkRounding * 7);        // beside it
  EXPECT_NEAR(distance(point, segment, straight, Vec3(2, 7, 3)), 7, kGjkRounding * 7);          // beyond its end
  EXPECT_NEAR(distance(segment, segment, straight, Vec3(3, 0.2, 4)), 5, kGjkRounding * 7);      // parallel
  EXPECT_NEAR(distance(segment, segment, alongX, Vec3(0.3, 0.6, 0.5)), 0.5, kGjkRounding * 7);  // crossing
  EXPECT_NEAR(distance(box, point, straight, Vec3(1.5, 1, 2)), 0.5, kGjkRounding * 7);          // face
  EXPECT_NEAR(distance(box, point, straight, Vec3(4, 6, 1)), 5, kGjkRounding * 7);              // edge
  EXPECT_NEAR(distance(box, point, straight, Vec3(3, 5, 9)), 7, kGjkRounding * 7);              // corner
  EXPECT_NEAR(distance(box, box, straight, Vec3(2.25, 1, -2)), 0.25, kGjkRounding * 7);         // faces
  EXPECT_NEAR(distance(box, box, straight, Vec3(5, 8, 1)), 5, kGjkRounding * 7);                // parallel edges
}

// Coordinates that are exact in binary: the difference of the nearest points is exactly zero.
TEST(Gjk, WhatTouchesExactlyHasNoDistance) {
  const SampleCore box = boxCore("box", Vec3(1, 2, 0.5)), plate = boxCore("plate", Vec3(4, 0.0625, 4));
  for (const Vec3& place :
       {Vec3(1, 0, 0), Vec3(1, 0.5, 0.25), Vec3(1, 2, 0.125), Vec3(1, 2, 0.5), Vec3(-1, -2, -0.5)}) {
    const CorePair pair{box, box, {}, {Quat::Identity(), place}};
    EXPECT_EQ(distanceOf(pair.a, pair.b).distance, 0) << place.transpose();
  }
  const CorePair onPlate{box, plate, {}, {Quat::Identity(), Vec3(0.25, -1.03125, 1)}};
  EXPECT_EQ(distanceOf(onPlate.a, onPlate.b).distance, 0);
  const CorePair same{box, box, {}, {}};
  EXPECT_EQ(distanceOf(same.a, same.b).distance, 0);
}

// However small it is, a distance is one: of faces, edges and corners, by a shift that is exact in binary.
TEST(Gjk, TellsTheSmallestDistancesFromTouching) {
  const SampleCore box = boxCore("box", Vec3(1, 2, 0.5));
  for (const double shift : {0x1p-20, 0x1p-35, 0x1p-46})
    for (const Vec3& place : {Vec3(1, 0.5, 0.125), Vec3(1, 2, 0.125), Vec3(1, 2, 0.5)}) {
      const CorePair pair{box, box, {}, {Quat::Identity(), place + shift * Vec3::UnitX()}};
      const GjkResult found = distanceOf(pair.a, pair.b);
      EXPECT_EQ(found.distance, shift) << place.transpose();
      EXPECT_EQ(found.normal, Vec3::UnitX());
    }
}

// Far from the origin a distance is known to the rounding of coordinates there, and no worse.
TEST(Gjk, KeepsTheDistanceFarFromTheOrigin) {
  const std::vector<SampleCore> cores = sampleCores(1);
  RandomPoses random(5);
  for (const SampleCore& a : cores)
    for (const SampleCore& b : cores) {
      const RigidTransform poseA = random.pose(1), poseB{random.turn(), Vec3(2.5, 0.3, 0.4)};
      const CorePair near{a, b, poseA, poseB};
      const Vec3 far(1e6, -2e6, 5e5);
      const CorePair away{a, b, {poseA.rotation, poseA.translation + far}, {poseB.rotation, poseB.translation + far}};
      const GjkResult expected = distanceOf(near.a, near.b), found = distanceOf(away.a, away.b);
      const double known = near.isRound() ? 1e-8 : 0;  // kRoundDistance
      EXPECT_NEAR(found.distance, expected.distance, kGjkRounding * 2e6 + known * expected.distance) << near.name();
    }
}

}  // namespace
}  // namespace cradle
