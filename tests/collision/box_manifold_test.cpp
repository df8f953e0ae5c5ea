#include "collision/predicted_manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
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

// Two cubes on an edge each, crossed, with half sides h and their centres H and z apart: along y, across both edges,
// they are apart by H - 2 sqrt(2) h, and along the lower one's side n = (0, 1, 1) / sqrt(2) by (H + z) / sqrt(2) - h -
// (1 + 1 / sqrt(2)) h. Edges carry where they are farther apart by more than 5e-4 m.
TEST(BoxesInContact, PreferSidesToEdgesThatAreHardlyFartherApart) {
  const double half = 0.1, root = std::sqrt(2.0), high = 2 * root * half - 0.002;
  const PosedBox below{Vec3::Zero(), turnedAbout(Vec3::UnitX(), std::atan(1.0)), Vec3::Constant(half)};
  for (const double part : {0.99, 1.01}) {
    const double onSide = -0.002 - part * 5e-4, beside = (onSide + (2 + 1 / root) * half) * root - high;
    ASSERT_LT(beside, half);  // the edges cross
    const PosedBox above{Vec3(0, high, beside), turnedAbout(Vec3::UnitZ(), std::atan(1.0)), Vec3::Constant(half)};
    const PredictedManifold patch = contactOfBoxes(below, above, Vec3::Zero(), 0.005);
    EXPECT_LT((patch.normal - (part < 1 ? Vec3(0, 1, 1) / root : Vec3(0, 1, 0))).norm(), 1e-12);
    if (part > 1) {
      EXPECT_NEAR(patch.points[0].separation, -0.002, 1e-12);
    }
  }
}

// The lower cube is tilted by an angle about x, the upper one stands on an edge along z, so that the normal of both
// edges is y. Where that is as near to the lower side's, within a cosine of 0.95, the side carries; where boxes slide,
// by more than 2e-3 m in a step, within 0.98.
TEST(BoxesInContact, CoverEdgesByASideThatFacesAsTheyDo) {
  const double half = 0.1;
  const auto normalAt = [&](double angle, double sliding) {
    const double edge = half * (std::cos(angle) + std::sin(angle));
    const PosedBox below{Vec3::Zero(), turnedAbout(Vec3::UnitX(), angle), Vec3::Constant(half)};
    const PosedBox above{Vec3(0, edge + std::sqrt(2.0) * half - 5e-4, -0.1), turnedAbout(Vec3::UnitZ(), std::atan(1.0)),
                         Vec3::Constant(half)};
    return contactOfBoxes(below, above, Vec3(sliding, 0, 0), 0.005).normal;
  };
  const auto isBySide = [&](double angle, double sliding) {
    const Vec3 normal = normalAt(angle, sliding), side(0, std::cos(angle), std::sin(angle));
    EXPECT_LT(std::min((normal - side).norm(), (normal - Vec3::UnitY()).norm()), 1e-12);
    return (normal - side).norm() < 1e-12;
  };
  for (const double part : {0.99, 1.01}) {
    EXPECT_EQ(isBySide(part * std::acos(0.95), 0), part < 1);
    EXPECT_EQ(isBySide(part * std::acos(0.98), 0.003), part < 1);
    EXPECT_EQ(isBySide(0.26, part * 2e-3), part < 1);  // between both angles
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
