#include "constraints/ball_joint.h"

#include <gtest/gtest.h>

#include "constraints/moving_ends.h"

namespace cradle {
namespace {

TEST(BallJoint, RatesAndVelocityProductsAreTheDerivativesOfItsError) {
  EXPECT_LT(largestDerivativeError(BallJointConstraint()), kDerivativeError);
}

TEST(BallJoint, ErrorIsWhatItsPointsAreApart) {
  for (const double size : {1.0, 1e-6, 1e6}) {
    const ConstraintEnds ends{fixedEnd(size * Vec3(1, 2, 3)), fixedEnd(size * Vec3(1.5, 1.75, 3))};
    const ConstraintBlock block = blockOf(BallJointConstraint(), ends);
    const Vec3 error(rowOf(block, 0).value, rowOf(block, 1).value, rowOf(block, 2).value);
    EXPECT_LT((error - size * Vec3(-0.5, 0.25, 0)).norm(), 1e-15 * size);
    EXPECT_EQ(block.scale, 1);
    EXPECT_NEAR(block.rounding[0], kRowRounding * 6 * size, 1e-29 * size);  // of the coordinates that enter
  }
}

// Multipliers are the force on A: it acts at the joint on both bodies, with the torque arm x force.
TEST(BallJoint, MultipliersAreAForceAtTheJoint) {
  const auto [endA, endB] = someMovingEnds();
  Mat3 rotationA, rotationB;
  const ConstraintEnds ends{endA.in(0, rotationA), endB.in(0, rotationB)};
  const ConstraintBlock block = blockOf(BallJointConstraint(), ends);
  const Vec3 force(3, -1, 2);
  Vec3 onA = Vec3::Zero(), onB = Vec3::Zero(), torqueA = Vec3::Zero(), torqueB = Vec3::Zero();
  for (int i = 0; i < 3; ++i) {
    const ConstraintRow row = rowOf(block, i);
    onA += force[i] * row.linearA, onB += force[i] * row.linearB;
    torqueA += force[i] * row.angularA, torqueB += force[i] * row.angularB;
  }
  EXPECT_EQ(onA, force);
  EXPECT_EQ(onB, Vec3(-force));
  EXPECT_LT((torqueA - ends.a.arm.cross(force)).norm(), 1e-15);
  EXPECT_LT((torqueB + ends.b.arm.cross(force)).norm(), 1e-15);
  EXPECT_TRUE(block.isPoint);
}

}  // namespace
}  // namespace cradle
