#include "dynamics/spring.h"

#include <cmath>

namespace cradle {

SpringAction actionOf(const SpringForce& spring, const VectorX& state) {
  return actionOf(spring, motionOf(spring.anchorA, state), motionOf(spring.anchorB, state));
}

SpringAction actionOf(const SpringForce& spring, const AttachmentMotion& a, const AttachmentMotion& b) {
  SpringAction action{a, b, Vec3::Zero(), 0, 0};
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
  const double inverseMass = inverseMassAlong(direction, spring.anchorA, bodies, state) +
                             inverseMassAlong(direction, spring.anchorB, bodies, state);
  return std::sqrt(spring.stiffness * inverseMass);
}

}  // namespace cradle
