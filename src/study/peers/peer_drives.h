#pragma once

#include <vector>

#include "constraints/joint_motor.h"
#include "math/prescribed_motion.h"

namespace cradle {

/// Velocities (m/s, rad/s; world) that take a driven body from its pose at one time (s) to that at a later one, less
/// than half a turn away, if they last.
struct MeanVelocity {
  Vec3 linear, angular;
};
MeanVelocity meanVelocity(const PrescribedMotion& motion, double from, double to);

/// What a motor of constant force does to body A of its joint: a torque (N m), and a force (N) at a point (m); world.
/// Body B gets the opposite of both, at the same point.
struct MotorAction {
  Vec3 point, force, torque;
};
MotorAction actionOf(const JointMotor& motor, const VectorX& state);

/// The motor of a joint; null if it has none.
const JointMotor* motorOf(const Constraint& joint, const std::vector<JointMotor>& motors);

}  // namespace cradle
