#include "constraints/joint_coordinate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "constraints/moving_ends.h"

namespace cradle {
namespace {

/// Of an axis askew in B, with the direction in A that is B's `across` at the start.
JointCoordinate someCoordinate(bool turns) {
  const Quat bFromA = rotationAbout(Vec3(1, -2, 0.5), 0.7);
  const Vec3 across = Vec3(2, 1, -2) / 3;
  return {turns, Vec3(1, 2, 2) / 3, bFromA.conjugate() * across, across, 0.3, 0.02};
}

constexpr double kCoordinateError = 1e-14;  // of some ten operations on numbers of a few m or rad

TEST(JointCoordinate, OfASliderIsTheWayAlongTheAxis) {
  const auto [endA, endB] = someMovingEnds();
  Mat3 rotationA, rotationB;
  ConstraintEnds ends{endA.in(0, rotationA), endB.in(0, rotationB)};
  const JointCoordinate slide = someCoordinate(false);
  ends.a.position = ends.b.position + rotationB * (0.8 * slide.axisB + 0.4 * slide.acrossB);
  EXPECT_NEAR(rowOf(blockOf(slide, ends), 0).value, 0.8 - 0.3, kCoordinateError);
  EXPECT_EQ(blockOf(slide, ends).compliance, 0.02);
}

TEST(JointCoordinate, OfASliderHasTheDerivativesOfItsRow) {
  EXPECT_LT(largestDerivativeError(someCoordinate(false)), kDerivativeError);
}

// Turned by q about the axis from where both directions are one. The coordinate is off by q - value, less whole turns.
TEST(JointCoordinate, OfAHingeIsTheTurnAboutTheAxis) {
  const auto [endA, endB] = someMovingEnds();
  Mat3 rotationA, rotationB;
  ConstraintEnds ends{endA.in(0, rotationA), endB.in(0, rotationB)};
  JointCoordinate turn = someCoordinate(true);
  const Mat3 bFromA = rotationAbout(Vec3(1, -2, 0.5), 0.7).toRotationMatrix();
  for (const double angle : {-3.0, -0.5, 0.0, 0.4, 2.9})
    for (const double value : {-20.0, -1.0, 0.3, 3.1, 7.0}) {
      turn.value = value;
      rotationA = rotationB * rotationAbout(turn.axisB, angle).toRotationMatrix() * bFromA;
      const double off = std::remainder(angle - value, 2 * std::numbers::pi);
      EXPECT_NEAR(rowOf(blockOf(turn, ends), 0).value, off, kCoordinateError) << angle << " " << value;
    }
}

// As A turns about the axis at some rate and with B besides, that is the rate of the row. Its velocity product is the
// rate of J v at constant velocities, whatever these are.
TEST(JointCoordinate, OfAHingeHasTheRateAboutTheAxis) {
  const auto [endA, endB] = someMovingEnds();
  const JointCoordinate turn = someCoordinate(true);
  for (const bool isFixed : {false, true}) {
    Mat3 rotationA, rotationB;
    ConstraintEnds ends{endA.in(0, rotationA), isFixed ? fixedEnd(Vec3(0.2, 1, -0.4)) : endB.in(0, rotationB)};
    const Vec3 axis = ends.b.turned(turn.axisB);
    const ConstraintRow row = rowOf(blockOf(turn, ends), 0);
    EXPECT_EQ(row.linearA, Vec3::Zero());
    EXPECT_NEAR(row.angularA.dot(ends.b.angularVelocity + 1.7 * axis) + row.angularB.dot(ends.b.angularVelocity), 1.7,
                kCoordinateError);
    const double second = timeDerivative([&](double time) { return rateOf(rowIn(time, turn, 0, isFixed), isFixed); });
    EXPECT_NEAR(row.velocityProduct, second, kDerivativeError);
    EXPECT_EQ(std::abs(second) > 0.1, !isFixed);
  }
}

// With anchors at the centres of mass the row turns bodies all the same.
TEST(JointCoordinate, TurnsBodiesWhereverItsAnchorsAre) {
  std::array<MovingEnd, 2> ends = someMovingEnds();
  for (MovingEnd& end : ends) end.point.setZero();
  Mat3 rotationA, rotationB;
  for (const bool turns : {false, true}) {
    const ConstraintBlock block = blockOf(someCoordinate(turns), {ends[0].in(0, rotationA), ends[1].in(0, rotationB)});
    EXPECT_TRUE(block.turnsA && block.turnsB);
    EXPECT_GT(rowOf(block, 0).angularB.norm(), 0.1);
  }
}

TEST(NearestTurn, DiffersByWholeTurnsAndByHalfATurnAtMost) {
  for (const double near : {-30.0, -0.2, 0.0, 3.0, 50.0}) {
    const double found = nearestTurn(1.25, near), turns = (found - 1.25) / (2 * std::numbers::pi);
    EXPECT_NEAR(turns, std::round(turns), 1e-14);
    EXPECT_LE(std::abs(found - near), std::numbers::pi + 1e-14);
  }
  EXPECT_EQ(nearestTurn(1.25, 1.25 + 3), 1.25);
  EXPECT_NEAR(nearestTurn(1.25, 1.25 + 3.2), 1.25 + 2 * std::numbers::pi, 1e-15);
}

}  // namespace
}  // namespace cradle
