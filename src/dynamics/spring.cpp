#include "dynamics/spring.h"

#include <cmath>

namespace cradle {

SpringAction actionOf(const SpringForce& spring, const VectorX& state) {
  const AttachmentMotion a = motionOf(spring.anchorA, state), b = motionOf(spring.anchorB, state);
  const SpringPull pull = pullOf(spring, a, b);
  const double extension = (a.position - b.position).norm() - spring.restLength;
  return {a, b, pull.forceOnA, 0.5 * spring.stiffness * extension * extension, pull.dissipation};
}

double naturalFrequency(const SpringForce& spring, const std::vector<RigidBody>& bodies, const VectorX& state) {
  const AttachmentMotion a = motionOf(spring.anchorA, state), b = motionOf(spring.anchorB, state);
  const Vec3 direction = (a.position - b.position).stableNormalized();
  const double inverseMass = inverseMassAlong(direction, spring.anchorA, bodies, state) +
                             inverseMassAlong(direction, spring.anchorB, bodies, state);
  return std::sqrt(spring.stiffness * inverseMass);
}

}  // namespace cradle
