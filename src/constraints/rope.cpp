#include "constraints/rope.h"

namespace cradle {

RopeMotion motionOf(const RopeLimit& rope, const VectorX& state) {
  RopeMotion motion{motionOf(rope.anchorA, state), motionOf(rope.anchorB, state), Vec3::Zero(), 0, 0};
  const Vec3 separation = motion.a.position - motion.b.position;
  motion.direction = separation.stableNormalized();
  motion.slackLength = rope.maxLength - separation.norm();
  motion.lengthening = motion.direction.dot(motion.a.velocity - motion.b.velocity);
  return motion;
}

ConstraintRow lengtheningRow(const RopeLimit& rope, const RopeMotion& motion) {
  const Vec3& u = motion.direction;
  return {rope.anchorA.body, rope.anchorB.body, u, motion.a.arm.cross(u), -u, -motion.b.arm.cross(u)};
}

double lengtheningAcceleration(const RopeLimit& rope, const VectorX& state, const VectorX& derivative) {
  // L'' = u.(a_A - a_B) + (|v|^2 - (u.v)^2) / L for the relative velocity v.
  const RopeMotion motion = motionOf(rope, state);
  const Vec3 velocity = motion.a.velocity - motion.b.velocity;
  const Vec3 acceleration = pointAcceleration(rope.anchorA.body, motion.a.position, state, derivative) -
                            pointAcceleration(rope.anchorB.body, motion.b.position, state, derivative);
  const double across = velocity.squaredNorm() - motion.lengthening * motion.lengthening;
  return motion.direction.dot(acceleration) + across / (rope.maxLength - motion.slackLength);
}

}  // namespace cradle
