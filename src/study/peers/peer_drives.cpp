#include "study/peers/peer_drives.h"

#include <algorithm>
#include <cmath>

namespace cradle {

MeanVelocity meanVelocity(const PrescribedMotion& motion, double from, double to) {
  const RigidTransform start = motionAt(motion, from).pose, end = motionAt(motion, to).pose;
  const Quat turn = end.rotation * start.rotation.conjugate();
  const double sine = turn.vec().norm();  // of half the angle
  const double angle = 2 * std::atan2(sine, std::abs(turn.w()));
  const Vec3 axis = sine > 0 ? Vec3(std::copysign(1 / sine, turn.w()) * turn.vec()) : Vec3::Zero();
  return {(end.translation - start.translation) / (to - from), angle / (to - from) * axis};
}

MotorAction actionOf(const JointMotor& motor, const VectorX& state) {
  const auto& [a, b, kind] = motor.joint;
  const JointCoordinate& coordinate = std::get<JointCoordinate>(kind);
  const Vec3 axis = b.body == kFixed ? coordinate.axisB : orientation(state, b.body) * coordinate.axisB;
  const Vec3 action = motor.sign * motor.maxForce * axis, none = Vec3::Zero();
  return {motionOf(a, state).position, coordinate.turns ? none : action, coordinate.turns ? action : none};
}

const JointMotor* motorOf(const Constraint& joint, const std::vector<JointMotor>& motors) {
  const auto areSame = [](const Attachment& a, const Attachment& b) { return a.body == b.body && a.point == b.point; };
  const bool isHinge = std::holds_alternative<HingeConstraint>(joint.kind);
  if (!isHinge && !std::holds_alternative<SliderConstraint>(joint.kind)) return nullptr;
  const auto found = std::find_if(motors.begin(), motors.end(), [&](const JointMotor& motor) {
    return areSame(motor.joint.anchorA, joint.anchorA) && areSame(motor.joint.anchorB, joint.anchorB) &&
           std::get<JointCoordinate>(motor.joint.kind).turns == isHinge;
  });
  return found == motors.end() ? nullptr : &*found;
}

}  // namespace cradle
