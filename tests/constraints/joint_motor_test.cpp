#include "constraints/joint_motor.h"

#include <gtest/gtest.h>

#include "constraints/constraint_row.h"
#include "constraints/tumbling_bodies.h"

namespace cradle {
namespace {

// 1e-11 s of F / m, and 1e-12 of the target velocity, or of 1 m/s.
TEST(JointMotor, IsAtItsTargetWithinWhatItsForceMendsAtOnceAndRounding) {
  JointMotor motor;
  motor.hasTarget = true, motor.maxForce = 5;
  EXPECT_NEAR(settledSpeed(motor, 3), 1.5e-10 + 1e-12, 1e-25);
  motor.targetVelocity = -0.5;
  EXPECT_NEAR(settledSpeed(motor, 3), 1.5e-10 + 1e-12, 1e-25);
  motor.targetVelocity = -40;
  EXPECT_NEAR(settledSpeed(motor, -3), 1.5e-10 + 4e-11, 1e-25);
  motor.maxForce = 0;
  EXPECT_NEAR(settledSpeed(motor, 3), 4e-11, 1e-25);
}

// About the axis u of body B, u . (w_A - w_B); along it, the rate of u . (a - b) of the anchors a and b, u turning with
// B: u . (a' - b') + (w_B x u) . (a - b).
TEST(JointMotor, HasARowOfItsCoordinatesRate) {
  const TumblingBodies at(2);
  std::vector<BodyFrame> frames;
  findBodyFrames(at.bodies, at.state, frames);
  const Attachment anchorA{0, Vec3(0.3, -0.2, 0.1)}, anchorB{1, Vec3(0.1, 0.4, -0.2)};
  const Vec3 axis(2.0 / 3, -1.0 / 3, 2.0 / 3), turned = orientation(at.state, 1) * axis;
  const Vec3 spinA = angularVelocity(at.state, 0), spinB = angularVelocity(at.state, 1);
  const Vec3 armA = orientation(at.state, 0) * anchorA.point, armB = orientation(at.state, 1) * anchorB.point;
  const Vec3 apart = centerOfMass(at.state, 0) + armA - centerOfMass(at.state, 1) - armB;
  const Vec3 parting =
      linearVelocity(at.state, 0) + spinA.cross(armA) - linearVelocity(at.state, 1) - spinB.cross(armB);
  for (const bool turns : {false, true}) {
    JointMotor motor;
    motor.joint = {anchorA, anchorB, JointCoordinate{turns, axis}};
    const ConstraintBlock block = rowOf(motor, at.state, frames);
    EXPECT_EQ(block.rows, 1);
    EXPECT_EQ(block.bodyA, 0);
    EXPECT_EQ(block.bodyB, 1);
    const double rate = turns ? turned.dot(spinA - spinB) : turned.dot(parting) + spinB.cross(turned).dot(apart);
    EXPECT_NEAR(rateOf(rowOf(block, 0), at.state), rate, 1e-14);  // of a dozen terms of some m/s or rad/s
  }
}

}  // namespace
}  // namespace cradle
