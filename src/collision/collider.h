#pragma once

#include <variant>
#include <vector>

#include "dynamics/rigid_body.h"
#include "math/types.h"

namespace cradle {

/// Points of a moving body, each with a ball of `radius` around it: a sphere is one, a capsule two, a box eight corners
/// with radius 0, a mesh its vertices. Enough to touch planes; only single balls touch each other.
struct BallsCollider {
  int body = kFixed;          // moving body, or kFixed: then points are in the world
  std::vector<Vec3> points;   // m, from the centre of mass in the body's frame
  double radius = 0;          // m
  double boundingRadius = 0;  // m, of all balls about the centre of mass
};

/// A half-space that does not move.
struct PlaneCollider {
  Vec3 point = Vec3::Zero();    // m, world
  Vec3 normal = Vec3::UnitY();  // unit, out of the solid
};

/// How two touching surfaces treat each other.
struct SurfaceLaw {
  double restitution = 0, staticFriction = 0, dynamicFriction = 0;
};

/// Two colliders that may touch.
struct ColliderPair {
  std::size_t a = 0, b = 0;  // indices into ContactGeometry: balls; balls or planes
  bool againstPlane = false;
  SurfaceLaw law;
};

struct ContactGeometry {
  std::vector<BallsCollider> balls;
  std::vector<PlaneCollider> planes;
  std::vector<ColliderPair> pairs;
};

}  // namespace cradle
