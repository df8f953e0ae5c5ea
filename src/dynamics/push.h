#pragma once

#include "dynamics/rigid_body.h"

namespace cradle {

/// A force that does not turn with the body, at a point that does; or a torque.
struct PushForce {
  Attachment point;
  Vec3 force = Vec3::Zero();   // N, world
  Vec3 torque = Vec3::Zero();  // N m, world
};

/// Power (W) that a push puts into its body.
double powerOf(const PushForce& push, const VectorX& state);

}  // namespace cradle
