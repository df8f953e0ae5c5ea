#include "collision/predicted_manifold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "collision/posed_boxes.h"

namespace cradle {
namespace {

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

}  // namespace
}  // namespace cradle
