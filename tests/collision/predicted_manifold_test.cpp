#include "collision/predicted_manifold.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/posed_boxes.h"

namespace cradle {
namespace {

// A patch without points tells how far apart the surfaces are at least: 50 mm and less.
TEST(Clearance, IsALowerBoundOfTheGap) {
  const PosedBox box{Vec3::Zero(), kStraight, Vec3::Constant(0.1)};
  const PosedBox other{Vec3(0.05, 0.25, 0), turnedAbout(Vec3::UnitY(), 0.4), Vec3::Constant(0.1)};
  const PosedSphere ball{Vec3(0, 0.2, 0), 0.05}, far{Vec3(0, 0.35, 0), 0.05};
  const PlaneCollider plane{Vec3(0, -0.15, 0), Vec3::UnitY(), 0};
  const Vec3 still = Vec3::Zero();
  for (const PredictedManifold& patch :
       {contactOfBoxes(box, other, still, 0.005), contactOfSpheres(ball, far, still, 0.005),
        contactOfSphereAndBox(ball, box, still, 0.005), contactOfBoxAndPlane(box, plane, still, 0.005)}) {
    EXPECT_EQ(patch.count, 0u);
    EXPECT_LT(patch.clearance, 0.05 + kExact);
    EXPECT_GT(patch.clearance, 0.04);
  }
  EXPECT_NEAR(contactOfSphereAndPlane({Vec3::Zero(), 0.05}, plane, still, 0.005).clearance, 0.1, kExact);
}

// Centres 0.5 m apart along x, 0.12 m to the side: they meet where they are 0.2 m apart, at 0.16 along x.
TEST(BallsInContact, HaveTheNormalOfTheInstantAtWhichTheyMeet) {
  const PosedSphere a{Vec3::Zero(), 0.1}, b{Vec3(0.5, 0.12, 0), 0.1};
  const PredictedManifold patch = contactOfSpheres(a, b, Vec3(-0.4, 0, 0), 0.005);
  ASSERT_EQ(patch.count, 1u);
  EXPECT_LT((patch.normal - Vec3(0.8, 0.6, 0)).norm(), kExact);
  EXPECT_NEAR(patch.points[0].separation, 0.8 * 0.34, kExact);
  EXPECT_EQ(contactOfSpheres(a, b, Vec3(-0.3, 0, 0), 0.005).count, 0u);
  EXPECT_EQ(contactOfSpheres(a, b, Vec3(0.4, 0, 0), 0.005).count, 0u);
}

TEST(BallAndBox, TouchAtCornersSidesAndFromInside) {
  const PosedBox box{Vec3::Zero(), kStraight, Vec3::Constant(0.1)};
  const Vec3 corner(0.1, 0.1, 0.1), out = Vec3(1, 2, 2) / 3;
  const PredictedManifold atCorner = contactOfSphereAndBox({corner + 0.099 * out, 0.1}, box, Vec3::Zero(), 0.005);
  ASSERT_EQ(atCorner.count, 1u);
  EXPECT_LT((atCorner.normal + out).norm(), 1e-13);
  EXPECT_NEAR(atCorner.points[0].separation, -0.001, kExact);
  const PredictedManifold inside = contactOfSphereAndBox({Vec3(0.01, 0.09, 0), 0.1}, box, Vec3::Zero(), 0.005);
  ASSERT_EQ(inside.count, 1u);
  EXPECT_LT((inside.normal + Vec3::UnitY()).norm(), kExact);
  EXPECT_NEAR(inside.points[0].separation, -0.11, kExact);
}

TEST(BoxOnPlane, StandsOnItsFourLowestCorners) {
  const PredictedManifold patch = contactOfBoxAndPlane({Vec3(0, 0.101, 0), kStraight, Vec3::Constant(0.1)},
                                                       {Vec3::Zero(), Vec3::UnitY(), 0}, Vec3::Zero(), 0.005);
  ASSERT_EQ(patch.count, 4u);
  for (const PredictedManifold::Point& point : patch.points) EXPECT_NEAR(point.separation, 0.001, kExact);
}

// Three points in a row and three on the other side, which is the larger area: but those are 10 mm farther away.
TEST(Patch, KeepsAllPointsThatMayCarryBeforeItSpansWhatIsFarther) {
  PredictedManifold::Point points[6];
  const double separations[] = {-1e-3, 1e-3, 0, 0.01, 0.011, 0.012};
  for (int k = 0; k < 6; ++k) {
    const double x = 0.02 * (k % 3), z = k < 3 ? 0 : 0.1;
    points[k] = {Vec3(x, 0, z), Vec3(x, separations[k], z), separations[k]};
  }
  PredictedManifold patch;
  appendSpanning(points, 6, patch);
  ASSERT_EQ(patch.count, 4u);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(patch.points[static_cast<std::size_t>(k)].onA, points[k].onA);
  EXPECT_EQ(patch.points[3].onA.z(), 0.1);
}

// A hexagon of 0.1 m, all of which may carry, and a corner 0.3 m away that does not touch.
TEST(Patch, SpansTheLargestAreaOfManyPointsThatMayCarry) {
  PredictedManifold::Point points[7];
  for (int k = 0; k < 6; ++k) {
    const double angle = k * std::acos(0.5);
    points[k] = {0.1 * Vec3(std::cos(angle), 0, std::sin(angle)), Vec3::Zero(), k == 2 ? -1e-3 : 0};
  }
  points[6] = {Vec3(-0.3, 0, 0), Vec3::Zero(), 0.01};
  PredictedManifold patch;
  appendSpanning(points, 7, patch);
  ASSERT_EQ(patch.count, 4u);
  EXPECT_EQ(patch.points[0].onA, points[2].onA);
  EXPECT_EQ(patch.points[1].onA, points[5].onA);
  const Vec3 across = points[2].onA.normalized().cross(Vec3::UnitY());
  EXPECT_NEAR(std::abs(across.dot(patch.points[2].onA)), 0.1 * std::sqrt(0.75), 1e-15);
  EXPECT_NEAR(across.dot(patch.points[3].onA), -across.dot(patch.points[2].onA), 1e-15);
}

}  // namespace
}  // namespace cradle
