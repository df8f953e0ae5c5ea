#pragma once

#include <array>

#include "collision/contact_patch.h"

namespace cradle {

/// The contact of two bodies that lasts over steps, and the impulses that held it in the last one.
struct ContactManifold {
  int bodyA = kFixed, bodyB = kFixed;  // A moves
  ContactPatch patch;
  std::array<double, ContactPatch::kMostPoints> impulses{};  // N s, along the normal, of each point
  Vec3 frictionImpulse = Vec3::Zero();                       // N s, world, on B at the patch's middle
  double twistImpulse = 0;                                   // N m s, about the normal, on B
  double friction = 0;                                       // coefficient of now
  SurfaceLaw law;
};

}  // namespace cradle
