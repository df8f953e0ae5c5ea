#include "dynamics/spring.h"

#include <cmath>

namespace cradle {
namespace {

double inverseMassAlong(const Vec3& direction, const Attachment& attachment, const Vec3& arm,
                        const std::vector<RigidBody>& bodies, const VectorX& state) {
  if (attachment.body == kFixed) return 0;
  const RigidBody& body = bodies[static_cast<std::size_t>(attachment.body)];
  const Vec3 lever = arm.cross(direction);
  return body.inverseMass + lever.dot(worldInverseInertia(body, orientation(state, attachment.body)) * lever);
}

}  // namespace

SpringAction actionOf(const SpringForce& spring, const VectorX& state) {
  SpringAction action{motionOf(spring.anchorA, state), motionOf(spring.anchorB, state), Vec3::Zero(), 0, 0};
  const Vec3 separation = action.a.position - action.b.position;
  const double length = separation.norm();
  const double extension = length - spring.restLength;
  action.potential = 0.5 * spring.stiffness * extension * extension;
  if (length == 0) return action;
  const Vec3 direction = separation / length;
  const double lengthening = direction.dot(action.a.velocity - action.b.velocity);
  action.forceOnA = -(spring.stiffness * extension + spring.damping * lengthening) * direction;
  action.dissipation = spring.damping * lengthening * lengthening;
  return action;
}

double naturalFrequency(const SpringForce& spring, const std::vector<RigidBody>& bodies, const VectorX& state) {
  const AttachmentMotion a = motionOf(spring.anchorA, state), b = motionOf(spring.anchorB, state);
  const Vec3 direction = (a.position - b.position).stableNormalized();
  const double inverseMass = inverseMassAlong(direction, spring.anchorA, a.arm, bodies, state) +
                             inverseMassAlong(direction, spring.anchorB, b.arm, bodies, state);
  return std::sqrt(spring.stiffness * inverseMass);
}

}  // namespace cradle
