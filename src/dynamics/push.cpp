#include "dynamics/push.h"

namespace cradle {

double powerOf(const PushForce& push, const VectorX& state) {
  const double ofForce = push.force.dot(motionOf(push.point, state).velocity);
  return push.torque.isZero() ? ofForce : push.torque.dot(angularVelocity(state, push.point.body));
}

}  // namespace cradle
