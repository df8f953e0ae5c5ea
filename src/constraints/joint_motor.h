#pragma once

#include "constraints/constraint.h"

namespace cradle {

/// 1/s: an error of the velocity of a motor that holds decays so fast.
constexpr double kMotorRelaxation = 10;

/// A drive of the coordinate of a slider or a hinge: a constant force, or the force that gives the coordinate a
/// velocity, up to a given one. Forces are in N along a slider's axis, in N m about a hinge's; of A against B.
struct JointMotor {
  /// A motor with a target velocity keeps it, with the force that this takes, or pushes with all the force that it has.
  /// One with a constant force pushes at all times.
  enum class Mode { holds, pushes };

  Constraint joint;  // whose kind is a JointCoordinate
  bool hasTarget = false;
  double targetVelocity = 0;  // m/s or rad/s
  double maxForce = 0;        // N or N m, >= 0; of a constant force its size
  double sign = 1;            // of the force with which it pushes
  Mode mode = Mode::pushes;
};

/// m/s or rad/s: a motor that misses its target by no more is at it, and is brought to it at once. All of its force
/// would mend that within an instant; or it is rounding. `mobility` (1/kg or 1/(kg m^2)) is what a force of 1 adds to
/// the acceleration of the coordinate.
double settledSpeed(const JointMotor& motor, double mobility);

/// The one row of a motor's coordinate: dq/dt = J v.
ConstraintBlock rowOf(const JointMotor& motor, const VectorX& state, const std::vector<BodyFrame>& frames);

}  // namespace cradle
