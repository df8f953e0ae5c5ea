#include "constraints/hinge.h"

#include <gtest/gtest.h>

#include "constraints/moving_ends.h"

namespace cradle {
namespace {

/// Of axes askew in both bodies' frames.
HingeConstraint someHinge() {
  return {Vec3(1, 2, 2) / 3, {Vec3(2, 1, -2) / 3, Vec3(2, -2, 1) / 3}};
}

TEST(Hinge, RatesAndVelocityProductsAreTheDerivativesOfItsError) {
  EXPECT_LT(largestDerivativeError(someHinge()), kDerivativeError);
}

// Bodies turned by an angle t from each other about a direction across the axis n: n . across = sin t for the other
// one.
TEST(Hinge, ErrorIsTheSineOfTheTilt) {
  const HingeConstraint hinge{Vec3::UnitZ(), {Vec3::UnitX(), Vec3::UnitY()}};
  const MovingEnd still{Vec3::Zero(), Vec3::Zero(), Vec3::UnitX(), Quat::Identity(), Vec3::Zero()};
  for (const double tilt : {1e-9, 0.3, -0.3})
    for (const double turn : {0.0, 1.2}) {  // B turns about the axis as it may
      Mat3 rotationA, rotationB = rotationAbout(Vec3::UnitZ(), turn).toRotationMatrix();
      MovingEnd tilted = still;
      tilted.start = rotationAbout(Vec3::UnitY(), tilt);  // z to (sin t, 0, cos t)
      ConstraintEnd b = still.in(0, rotationA);
      b.rotation = &rotationB;
      Mat3 rotationTilted;
      const ConstraintBlock block = blockOf(hinge, {tilted.in(0, rotationTilted), b});
      EXPECT_NEAR(rowOf(block, 3).value, std::sin(tilt) * std::cos(turn), 1e-15);
      EXPECT_NEAR(rowOf(block, 4).value, -std::sin(tilt) * std::sin(turn), 1e-15);
      EXPECT_EQ(rowOf(block, 3).rounding, kRowRounding);
    }
}

// A turn about the axis changes nothing: the rows of the axis have torques across it alone, opposite for both bodies,
// and no force.
TEST(Hinge, LeavesTheTurnAboutItsAxis) {
  const auto [endA, endB] = someMovingEnds();
  const Vec3 axis(0.6, 0, 0.8), across(0.8, 0, -0.6);
  Mat3 rotationA, rotationB;
  const ConstraintEnds ends{endA.in(0, rotationA), endB.in(0, rotationB)};
  const HingeConstraint hinge{rotationA.transpose() * axis,
                              {rotationB.transpose() * across, rotationB.transpose() * Vec3::UnitY()}};
  const ConstraintBlock block = blockOf(hinge, ends);
  for (const int i : {3, 4}) {
    const ConstraintRow row = rowOf(block, i);
    EXPECT_NEAR(row.value, 0, 1e-15);
    EXPECT_NEAR(row.angularA.dot(axis), 0, 1e-15);
    EXPECT_NEAR(row.angularA.norm(), 1, 1e-14);
    EXPECT_EQ(row.angularB, Vec3(-row.angularA));
    EXPECT_EQ(row.linearA, Vec3::Zero());
  }
  const Vec3 first = rowOf(block, 3).angularA;
  EXPECT_LT((first - axis.cross(across)).norm(), 1e-14);
}

// With anchors at the centres of mass the point's rows turn nothing, but the axis's rows do. A zero in place of one
// direction makes an empty row.
TEST(Hinge, TurnsBodiesWhereverItsAnchorsAre) {
  std::array<MovingEnd, 2> ends = someMovingEnds();
  for (MovingEnd& end : ends) end.point.setZero();
  HingeConstraint hinge = someHinge();
  hinge.acrossB[1].setZero();
  Mat3 rotationA, rotationB;
  const ConstraintBlock block = blockOf(hinge, {ends[0].in(0, rotationA), ends[1].in(0, rotationB)});
  EXPECT_TRUE(block.turnsA && block.turnsB);
  EXPECT_EQ(rowOf(block, 1).angularA, Vec3::Zero());
  EXPECT_GT(rowOf(block, 3).angularA.norm(), 0.1);
  EXPECT_EQ(rowOf(block, 4).angularA, Vec3::Zero());
  EXPECT_EQ(rowOf(block, 4).value, 0);
}

}  // namespace
}  // namespace cradle
