#include "collision/predicted_manifold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace cradle {
namespace {

constexpr double kExact = 1e-14;  // m: rounding of coordinates below 1 m
const Mat3 kStraight = Mat3::Identity();

Mat3 turnedAbout(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

// A cube of 0.2 m on one of 0.4 m, 1 mm deep: its four lower corners.
TEST(BoxesInContact, CarryEachOtherOnFourCornersOfTheSmallerSide) {
  const PosedBox below{Vec3::Zero(), kStraight, Vec3::Constant(0.2)};
  const PosedBox above{Vec3(0.02, 0.299, 0.03), turnedAbout(Vec3::UnitY(), 0.3), Vec3::Constant(0.1)};
  const PredictedManifold patch = contactOfBoxes(below, above, Vec3::Zero(), 0.005);
  ASSERT_EQ(patch.count, 4u);
  EXPECT_LT((patch.normal - Vec3::UnitY()).norm(), kExact);
  Vec3 middle = Vec3::Zero();
  for (const PredictedManifold::Point& point : patch.points) {
    EXPECT_NEAR(point.separation, -0.001, kExact);
    EXPECT_NEAR(point.onB.y(), 0.199, kExact);
    EXPECT_NEAR(point.onA.y(), 0.2, kExact);
    EXPECT_NEAR((point.onB - above.center).norm(), 0.1 * std::sqrt(3.0), kExact);
    middle += point.onB / 4;
  }
  EXPECT_LT((middle - Vec3(0.02, 0.199, 0.03)).norm(), kExact);
}

// Two cubes that stand on an edge each, crossed: the upper's lowest edge on the lower's highest.
TEST(BoxesInContact, TouchInOnePointWhereEdgesCross) {
  const double high = 0.1 * std::sqrt(2.0);
  const PosedBox below{Vec3::Zero(), turnedAbout(Vec3::UnitX(), std::atan(1.0)), Vec3::Constant(0.1)};
  const PosedBox above{Vec3(0.03, 2 * high - 0.002, -0.04), turnedAbout(Vec3::UnitZ(), std::atan(1.0)),
                       Vec3::Constant(0.1)};
  const PredictedManifold patch = contactOfBoxes(below, above, Vec3::Zero(), 0.005);
  ASSERT_EQ(patch.count, 1u);
  EXPECT_LT((patch.normal - Vec3::UnitY()).norm(), 1e-12);
  EXPECT_NEAR(patch.points[0].separation, -0.002, 1e-12);
  EXPECT_LT((patch.points[0].onA - Vec3(0.03, high, 0)).norm(), 1e-12);
  EXPECT_LT((patch.points[0].onB - Vec3(0.03, high - 0.002, 0)).norm(), 1e-12);
}

// Nearly level on each other, turned about the vertical: edges of the facing sides cross, and seen along their common
// perpendicular the cubes overlap by up to 1 mm less. One point there would let the upper one tip.
TEST(BoxesInContact, LieOnSidesNotOnCrossingEdgesWhenNearlyLevel) {
  const PosedBox below{Vec3::Zero(), kStraight, Vec3::Constant(0.1)};
  for (const double height : {0.197, 0.21})
    for (int yaw = 0; yaw < 16; ++yaw)
      for (int about = 0; about < 8; ++about) {
        const Vec3 axis(std::cos(0.8 * about), 0, std::sin(0.8 * about));
        const Mat3 turn = turnedAbout(axis, 0.02) * turnedAbout(Vec3::UnitY(), 0.1 * yaw);
        const PosedBox above{Vec3(0.06, height, 0.05), turn, Vec3::Constant(0.1)};
        const PredictedManifold patch = contactOfBoxes(below, above, Vec3(0, 0.197 - height, 0), 0.005);
        EXPECT_EQ(patch.count, 4u) << height << " " << yaw << " " << about;
      }
}

/// Separation (m, < 0: overlap) along the axis that tells most, of all 15. (S. Gottschalk, M. C. Lin, D. Manocha,
/// "OBBTree", SIGGRAPH 1996)
double greatestSeparation(const PosedBox& a, const PosedBox& b) {
  std::vector<Vec3> axes;
  for (int i = 0; i < 3; ++i) {
    axes.push_back(a.axes.col(i)), axes.push_back(b.axes.col(i));
    for (int j = 0; j < 3; ++j) axes.push_back(a.axes.col(i).cross(b.axes.col(j)));
  }
  double greatest = -std::numeric_limits<double>::infinity();
  for (const Vec3& axis : axes) {
    if (axis.norm() < 1e-3) continue;
    const Vec3 unit = axis.normalized();
    const double reach =
        (a.axes.transpose() * unit).cwiseAbs().dot(a.halfSize) + (b.axes.transpose() * unit).cwiseAbs().dot(b.halfSize);
    greatest = std::max(greatest, std::abs(unit.dot(b.center - a.center)) - reach);
  }
  return greatest;
}

// Boxes that are apart, or all but, are not pushed out of a depth that is none: by less than the margin within which
// contact is seen. (Sides carry contact in place of edges that face as they do; where boxes beside each other count as
// lying on each other, it is 20 mm.)
TEST(BoxesInContact, AreNoDeeperThanTheBoxes) {
  std::mt19937 engine(11);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto vector = [&] { return Vec3(number(engine), number(engine), number(engine)); };
  int met = 0;
  double deepest = 0;
  for (int trial = 0; trial < 400000; ++trial) {
    const PosedBox a{Vec3::Zero(), turnedAbout(vector(), 3 * number(engine)), Vec3::Constant(0.1)};
    const PosedBox b{0.3 * vector(), turnedAbout(vector(), 3 * number(engine)), Vec3::Constant(0.1)};
    const double separation = greatestSeparation(a, b);
    if (separation < -0.005 || separation > 0.005) continue;
    const PredictedManifold patch = contactOfBoxes(a, b, Vec3::Zero(), 0.005);
    for (std::size_t i = 0; i < patch.count; ++i) deepest = std::max(deepest, separation - patch.points[i].separation);
    met += patch.count > 0;
  }
  EXPECT_GT(met, 5000);
  EXPECT_LT(deepest, 0.005);
}

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

// Diagonally above, and falling 0.1 m in the step: beside the other cube it falls past; when it comes nearer sideways
// at the same time it will land on it, though the gap sideways is the larger one now.
TEST(BoxesInContact, AreThoseOfTheInstantAtWhichTheyWillMeet) {
  const PosedBox below{Vec3::Zero(), kStraight, Vec3::Constant(0.1)};
  const PosedBox beside{Vec3(0.21, 0.23, 0), kStraight, Vec3::Constant(0.1)};
  EXPECT_EQ(contactOfBoxes(below, beside, Vec3(0, -0.1, 0), 0.005).count, 0u);
  const PosedBox coming{Vec3(0.24, 0.23, 0), kStraight, Vec3::Constant(0.1)};
  const PredictedManifold patch = contactOfBoxes(below, coming, Vec3(-0.2, -0.1, 0), 0.005);
  ASSERT_EQ(patch.count, 4u);
  EXPECT_LT((patch.normal - Vec3::UnitY()).norm(), kExact);
  for (const PredictedManifold::Point& point : patch.points) EXPECT_NEAR(point.separation, 0.03, kExact);
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
