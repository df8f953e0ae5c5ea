#include "constraints/slider.h"

#include <gtest/gtest.h>

#include "constraints/moving_ends.h"

namespace cradle {
namespace {

/// Of an axis (1, 2, 2) / 3 of B, askew in both bodies' frames.
SliderConstraint someSlider() {
  return {{Vec3(2, 1, -2) / 3, Vec3(-2, 2, -1) / 3}, rotationAbout(Vec3(1, -2, 0.5), 0.7).toRotationMatrix()};
}

TEST(Slider, RatesAndVelocityProductsAreTheDerivativesOfItsError) {
  EXPECT_LT((someSlider().axisB() - Vec3(1, 2, 2) / 3).norm(), 1e-15);
  EXPECT_LT(largestDerivativeError(someSlider()), kDerivativeError);
}

// The displacement of anchor A from anchor B, in the directions of B across the axis; along it, nothing is kept.
TEST(Slider, ErrorIsTheDisplacementAcrossTheAxis) {
  const auto [endA, endB] = someMovingEnds();
  Mat3 rotationA, rotationB;
  ConstraintEnds ends{endA.in(0, rotationA), endB.in(0, rotationB)};
  const SliderConstraint slider = someSlider();
  ends.a.position =
      ends.b.position + rotationB * (5 * slider.axisB() + 0.3 * slider.acrossB[0] - 0.2 * slider.acrossB[1]);
  const ConstraintBlock block = blockOf(slider, ends);
  EXPECT_FALSE(block.isPoint);
  EXPECT_NEAR(rowOf(block, 0).value, 0.3, 1e-14);
  EXPECT_NEAR(rowOf(block, 1).value, -0.2, 1e-14);
}

// The reaction is one force, in anchor A, across the axis: opposite forces and moments (about the world's origin) on
// both bodies, and no power where A moves along the axis as it may.
TEST(Slider, ReactionIsOneForceAcrossTheAxis) {
  const auto [endA, endB] = someMovingEnds();
  Mat3 rotationA, rotationB;
  const ConstraintEnds ends{endA.in(0, rotationA), endB.in(0, rotationB)};
  const SliderConstraint slider = someSlider();
  const ConstraintBlock block = blockOf(slider, ends);
  const Vec3 centerA = ends.a.position - ends.a.arm, centerB = ends.b.position - ends.b.arm;
  for (int i = 0; i < SliderConstraint::kRows; ++i) {
    const ConstraintRow row = rowOf(block, i);
    EXPECT_EQ(row.linearB, Vec3(-row.linearA));
    const Vec3 moment = centerA.cross(row.linearA) + row.angularA + centerB.cross(row.linearB) + row.angularB;
    EXPECT_LT(moment.norm(), 1e-14);
    EXPECT_NEAR(row.linearA.dot(rotationB * slider.axisB()), 0, 1e-15);
    if (i < 2) {
      EXPECT_LT((row.angularA - ends.a.arm.cross(row.linearA)).norm(), 1e-15);
    }
  }
}

// With anchors at the centres of mass the rows across the axis turn B as far as A is along it.
TEST(Slider, TurnsBodiesWhereverItsAnchorsAre) {
  std::array<MovingEnd, 2> ends = someMovingEnds();
  for (MovingEnd& end : ends) end.point.setZero();
  Mat3 rotationA, rotationB;
  const ConstraintBlock block = blockOf(someSlider(), {ends[0].in(0, rotationA), ends[1].in(0, rotationB)});
  EXPECT_TRUE(block.turnsA && block.turnsB);
  EXPECT_EQ(rowOf(block, 0).angularA, Vec3::Zero());
  EXPECT_GT(rowOf(block, 0).angularB.norm(), 0.1);
  EXPECT_GT(rowOf(block, 2).angularA.norm(), 0.1);
}

}  // namespace
}  // namespace cradle
