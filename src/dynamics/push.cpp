#include "dynamics/push.h"

namespace cradle {

double powerOf(const PushForce& push, const VectorX& state) {
  return push.force.dot(motionOf(push.point, state).velocity);
}

}  // namespace cradle
