#pragma once

#include "constraints/constraint.h"

namespace cradle {

/// What works on the coordinate of a slider or a hinge: with a constant force, or so that the coordinate has a
/// velocity, with at most a given force. Forces are in N along a slider's axis, in N m about a hinge's; of A against B.
struct JointMotor {
  /// What a motor with a target velocity does now: keeps it, with the force that this takes, or pushes with all that it
  /// has. One with a constant force pushes at all times.
  enum class Mode { holds, pushes };

  Constraint joint;  // whose kind is a JointCoordinate
  bool hasTarget = false;
  double targetVelocity = 0;  // m/s or rad/s
  double maxForce = 0;        // N or N m, >= 0; of a constant force its size
  double sign = 1;            // of the force with which it pushes
  Mode mode = Mode::pushes;
};

/// The row of a motor's coordinate: dq/dt = J v.
ConstraintRow rowOf(const JointMotor& motor, const VectorX& state, const std::vector<BodyFrame>& frames);

}  // namespace cradle
