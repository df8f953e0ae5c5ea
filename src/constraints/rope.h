#pragma once

#include "constraints/constraint_row.h"

namespace cradle {

/// A massless rope between two points: nothing while it is shorter than maxLength, never longer.
struct RopeLimit {
  Attachment anchorA, anchorB;
  double maxLength = 0;    // m, > 0
  double restitution = 0;  // 0..1, of the impulse when it goes taut
};

/// How a rope is stretched out at one instant.
struct RopeMotion {
  AttachmentMotion a, b;
  Vec3 direction;      // unit, from anchor B to anchor A
  double slackLength;  // m, maxLength - distance: <= 0 is taut
  double lengthening;  // m/s
};
RopeMotion motionOf(const RopeLimit& rope, const VectorX& state);

/// The row of the lengthening; its multiplier pushes the ends apart.
ConstraintRow lengtheningRow(const RopeLimit& rope, const RopeMotion& motion);

/// d^2/dt^2 of the distance of a rope's ends (m/s^2), for the rates of all velocities in `derivative`.
double lengtheningAcceleration(const RopeLimit& rope, const VectorX& state, const VectorX& derivative);

}  // namespace cradle
