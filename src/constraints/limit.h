#pragma once

#include <utility>
#include <variant>

#include "constraints/constraint.h"

namespace cradle {

/// A massless rope between two points: nothing while it is shorter than maxLength, never longer.
struct RopeLimit {
  Attachment anchorA, anchorB;
  double maxLength = 0;    // m, > 0
  double restitution = 0;  // 0..1, of the impulse when it goes taut
};

/// A stop of a slider or a hinge: nothing while the joint's coordinate is below a bound, or above it, and never beyond.
struct JointLimit {
  Attachment anchorA, anchorB;
  JointCoordinate bound;   // whose value is the bound
  double side = 1;         // 1: the most, -1: the least
  double size = 1;         // m, of the bodies: what is measured against it, and the radius at which a hinge's stop acts
  double restitution = 0;  // 0..1, of the impulse when it is reached
  // Of a hinge when it was followed last: its coordinate (rad), whole turns counted, and the rate of that (rad/s).
  double turned = 0, rate = 0;

  double unit() const { return bound.turns ? size : 1; }  // m of slack a unit of the coordinate
};

/// A unilateral constraint at the ends of a link: what it leaves of motion is its slack, in m.
using Limit = std::variant<RopeLimit, JointLimit>;

/// Bodies A and B; kFixed.
std::pair<int, int> bodiesOf(const Limit& limit);

/// The length (m) that tolerances are parts of.
double sizeOf(const Limit& limit);
double restitutionOf(const Limit& limit);

/// How a limit stands at one instant. It acts at one point of both bodies along one line: the rope's, the slider's
/// axis, or across the moment arm of a hinge's stop, whose forces beside the torque are the hinge's own.
struct LimitMotion {
  AttachmentMotion a, b;  // of the ends of a rope; of a stop both are the point where it acts
  Vec3 direction;         // unit: A goes along it to the limit
  double slackLength;     // m: <= 0 is at the limit
  double lengthening;     // m/s, to the limit
};
LimitMotion motionOf(const Limit& limit, const VectorX& state);

/// The slack (m) of a stop for the poses of its bodies' centres of mass: of a hinge that of the turns that is nearest
/// to where it was followed last and `turning` (rad) on.
double slackOf(const JointLimit& limit, const RigidTransform& poseA, const RigidTransform& poseB, double turning);

/// The angle (rad) by which a hinge turns from where it was followed last until it comes to `state` in `time` (s), if
/// its rate changes evenly meanwhile.
double turningTo(const JointLimit& limit, double time, const VectorX& state);

/// Follows a hinge to `state`, to which it has come in `time` (s), within half a turn of what `turningTo` says.
void followTurn(JointLimit& limit, double time, const VectorX& state);

/// The one row of the lengthening; its multiplier pushes A away from the limit if it is < 0.
ConstraintBlock lengtheningRow(const Limit& limit, const LimitMotion& motion);

/// d/dt of the lengthening (m/s^2), for the rates of all velocities in `derivative`.
double lengtheningAcceleration(const Limit& limit, const VectorX& state, const VectorX& derivative);

/// The bilateral constraint that a limit is while something presses against it.
Constraint constraintOf(const Limit& limit);

/// The force (N) with which it then pulls, or pushes, for the multiplier of that constraint's row.
double tensionOf(const Limit& limit, double multiplier);

}  // namespace cradle
