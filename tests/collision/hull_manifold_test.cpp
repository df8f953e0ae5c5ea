#include "collision/hull_manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "collision/gjk.h"
#include "collision/posed_boxes.h"
#include "collision/random_poses.h"
#include "collision/separating_axis.h"

namespace cradle {
namespace {

constexpr double kHullMargin = 5e-3;  // m
const Box kHullCube{Vec3::Constant(0.2)};

/// 12 corners on a sphere of 0.1 m, moved a little so that no four of them lie in a plane.
Collider hullOf(RandomPoses& random) {
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i) points.push_back(0.1 * random.direction());
  return colliderOf(convexHullOf(points), {});
}

PredictedManifold contactOfPosed(const Collider& a, const RigidTransform& poseA, const Collider& b,
                                 const RigidTransform& poseB, const Vec3& motion) {
  HullAxis axis = Vec3::Zero();
  return contactOfHulls(Core(a, poseA), Core(b, poseB), motion, kHullMargin, 1, axis);
}

double deepestOfHulls(const PredictedManifold& manifold) {
  double deepest = INFINITY;
  for (std::size_t i = 0; i < manifold.count; ++i) deepest = std::min(deepest, manifold.points[i].separation);
  return deepest;
}

// Cubes of 0.2 m as hulls and as boxes, one on the other: pressed in by 1 mm, at rest, and 0.3 m above at 0.5 m a step.
TEST(CubesAsHulls, HaveTheContactOfBoxes) {
  const Collider cube = colliderOf(kHullCube, {});
  for (const auto& [height, motion] : {std::pair{0.199, 0.0}, {0.2, 0.0}, {0.203, 0.0}, {0.5, -0.5}}) {
    const RigidTransform pose{rotationAbout(Vec3::UnitY(), 0.3), Vec3(0.03, height, -0.02)};
    const Vec3 way(0, motion, 0);
    const PredictedManifold hulls = contactOfPosed(cube, {}, cube, pose, way);
    const PosedBox below{Vec3::Zero(), kStraight, kHullCube.size / 2};
    const PosedBox above{pose.translation, pose.rotation.toRotationMatrix(), kHullCube.size / 2};
    const PredictedManifold boxes = contactOfBoxes(below, above, way, kHullMargin);
    ASSERT_EQ(hulls.count, boxes.count);
    EXPECT_LT((hulls.normal - boxes.normal).norm(), 1e-12);
    for (std::size_t i = 0; i < hulls.count; ++i) {
      EXPECT_NEAR(hulls.points[i].separation, height - 0.2, 1e-12);
      EXPECT_NEAR((hulls.points[i].onB - hulls.points[i].onA).norm(), std::abs(height - 0.2), 1e-12);
    }
  }
}

// A cube that falls aslant meets the other's face where it comes to it, above 0.03 to 0.1 m: now it is beside it.
TEST(CubesAsHulls, MeetWhereTheyComeTo) {
  const Collider cube = colliderOf(kHullCube, {});
  const RigidTransform pose{Quat::Identity(), Vec3(0.25, 0.5, 0)};
  const PredictedManifold found = contactOfPosed(cube, {}, cube, pose, Vec3(-0.2, -0.5, 0));
  ASSERT_EQ(found.count, 4u);
  EXPECT_LT((found.normal - Vec3::UnitY()).norm(), 1e-12);
  Vec3 middle = Vec3::Zero();
  for (const PredictedManifold::Point& point : found.points) {
    EXPECT_NEAR(point.separation, 0.3, 1e-12);
    middle += point.onA / 4;
  }
  EXPECT_LT((middle - Vec3(0.065, 0.1, 0)).norm(), 1e-4);  // they have met when they are 0.1 mm apart
}

// A cube on an edge falls on a cube: the edge is a point over the middle of the face, or its line.
TEST(CubesAsHulls, FallOnAnEdge) {
  const Collider cube = colliderOf(kHullCube, {});
  const RigidTransform tilted{rotationAbout(Vec3::UnitZ(), std::acos(-1) / 4), Vec3(0, 0.1 + 0.1 * std::sqrt(2), 0)};
  const PredictedManifold found = contactOfPosed(cube, {}, cube, tilted, Vec3::Zero());
  ASSERT_GE(found.count, 2u);
  EXPECT_LT((found.normal - Vec3::UnitY()).norm(), 1e-12);
  double least = INFINITY, most = -INFINITY;
  for (std::size_t i = 0; i < found.count; ++i) {
    if (found.points[i].separation > 1e-12) continue;
    least = std::min(least, found.points[i].onA.z()), most = std::max(most, found.points[i].onA.z());
  }
  EXPECT_NEAR(least, -0.1, 1e-12);
  EXPECT_NEAR(most, 0.1, 1e-12);
}

// Two edges that cross meet in one point, with the normal across both.
TEST(CubesAsHulls, MeetByEdgesThatCross) {
  const Collider cube = colliderOf(kHullCube, {});
  const double quarter = std::acos(-1) / 4, apart = 0.2 * std::sqrt(2) - 1e-3;
  const RigidTransform below{rotationAbout(Vec3::UnitZ(), quarter), Vec3::Zero()};
  const RigidTransform above{rotationAbout(Vec3::UnitX(), quarter), Vec3(0, apart, 0)};
  const PredictedManifold found = contactOfPosed(cube, below, cube, above, Vec3::Zero());
  ASSERT_EQ(found.count, 1u);
  EXPECT_LT((found.normal - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(found.points[0].separation, -1e-3, 1e-12);
  EXPECT_LT((found.points[0].onA - Vec3(0, 0.1 * std::sqrt(2), 0)).norm(), 1e-12);
}

// Hulls without a contact do not meet in the step, are farther apart than the margin before and after it, and as far as
// they are said to be; hulls with one come as near. GJK tells distances to rounding.
TEST(Hulls, HaveContactWhereTheyComeNear) {
  RandomPoses random(3);
  int met = 0;
  for (int k = 0; k < 600; ++k) {
    const Collider a = hullOf(random), b = hullOf(random);
    const RigidTransform poseA = random.pose(0.05), poseB = random.pose(0.25);
    const Vec3 motion = random.vector(0.2);
    const PredictedManifold found = contactOfPosed(a, poseA, b, poseB, motion);
    const Core coreA(a, poseA), coreB(b, poseB);
    double nearest = INFINITY;
    for (int i = 0; i <= 200; ++i)
      nearest = std::min(nearest, distanceOf(coreA, coreB.moved(i / 200.0 * motion)).distance);
    if (found.count == 0) {
      EXPECT_GT(nearest, 0);
      EXPECT_GT(distanceOf(coreA, coreB.moved(motion)).distance, kHullMargin);
      EXPECT_GT(distanceOf(coreA, coreB).distance, kHullMargin);
      EXPECT_LE(found.clearance, distanceOf(coreA, coreB).distance + 1e-12);
    } else {
      ++met;
      EXPECT_LT(nearest, kHullMargin + 0.2 / 200 * std::sqrt(3));  // between two looks they move by that
    }
  }
  EXPECT_GT(met, 100);
}

// Hulls that overlap by some millimetres: some point is as deep as the least translation that separates them, but for
// the preference for faces, 0.5 mm; and none is deeper, but for faces that cover an edge, 2 mm. (In one of them the
// face that covers the edge has nothing as deep over it.)
TEST(Hulls, AreAsDeepAsTheyOverlap) {
  RandomPoses random(5);
  int overlapped = 0;
  for (int k = 0; k < 1000; ++k) {
    const Collider a = hullOf(random), b = hullOf(random);
    const RigidTransform poseA{random.turn(), Vec3::Zero()};
    RigidTransform poseB{random.turn(), 0.3 * random.direction()};
    const GjkResult apart = distanceOf(Core(a, poseA), Core(b, poseB));
    poseB.translation -= (apart.distance + 4e-3) * apart.normal;
    const Core coreA(a, poseA), coreB(b, poseB);
    const SeparatingAxes axes = separatingAxes(coreA, coreB);
    const double overlap = std::max({axes.faceOfA.separation, axes.faceOfB.separation, axes.edges.separation});
    if (overlap > -1e-3) continue;
    const PredictedManifold found = contactOfPosed(a, poseA, b, poseB, Vec3::Zero());
    ASSERT_GT(found.count, 0u);
    EXPECT_LT(deepestOfHulls(found), overlap + 5e-4);
    EXPECT_GT(deepestOfHulls(found), overlap - 2e-3);
    ++overlapped;
  }
  EXPECT_GT(overlapped, 700);
}

// While hulls pass each other, what is known from the step before changes nothing: the same contact, or none.
TEST(Hulls, ThatWereLookedAtBeforeHaveTheSameContact) {
  RandomPoses random(7);
  for (int k = 0; k < 60; ++k) {
    const Collider a = hullOf(random), b = hullOf(random);
    const RigidTransform poseA{random.turn(), Vec3::Zero()};
    const Vec3 from = 0.25 * random.direction(), spin = random.direction(), motion = -0.02 * from.normalized();
    const Quat turn = random.turn();
    HullAxis axis = Vec3::Zero();
    for (int i = 0; i < 6; ++i) {
      const RigidTransform poseB{rotationAbout(spin, 0.05 * i) * turn, from + i * motion};
      const Core coreA(a, poseA), coreB(b, poseB);
      const PredictedManifold kept = contactOfHulls(coreA, coreB, motion, kHullMargin, 1, axis);
      const PredictedManifold anew = contactOfPosed(a, poseA, b, poseB, motion);
      ASSERT_EQ(kept.count, anew.count);
      if (anew.count == 0) continue;
      EXPECT_LT((kept.normal - anew.normal).norm(), 1e-9);
      EXPECT_NEAR(deepestOfHulls(kept), deepestOfHulls(anew), 1e-9);
    }
  }
}

TEST(HullOnPlane, StandsOnItsLowestCorners) {
  const PlaneCollider floor{Vec3(0, -0.1, 0), Vec3::UnitY(), 0};
  const Collider cube = colliderOf(kHullCube, {});
  const RigidTransform standing{rotationAbout(Vec3::UnitY(), 0.4), Vec3(0, 1e-3, 0)};
  const PredictedManifold found = contactOfHullAndPlane(Core(cube, standing), floor, Vec3::Zero(), kHullMargin, 1);
  ASSERT_EQ(found.count, 4u);
  for (const PredictedManifold::Point& point : found.points) {
    EXPECT_NEAR(point.separation, 1e-3, 1e-15);
    EXPECT_NEAR(point.onB.y(), -0.1, 1e-15);
  }
  const RigidTransform high{Quat::Identity(), Vec3(0, 0.05, 0)};
  const PredictedManifold none = contactOfHullAndPlane(Core(cube, high), floor, Vec3::Zero(), kHullMargin, 1);
  EXPECT_EQ(none.count, 0u);
  EXPECT_NEAR(none.clearance, 0.05, 1e-15);
  EXPECT_EQ(contactOfHullAndPlane(Core(cube, high), floor, Vec3(0, 0.06, 0), kHullMargin, 1).count, 4u);
}

}  // namespace
}  // namespace cradle
