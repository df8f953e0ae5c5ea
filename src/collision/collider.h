#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "collision/polytope.h"
#include "dynamics/rigid_body.h"

namespace cradle {

/// The shape of a body for contact: points with a ball of `radius` around each. A sphere is one, a capsule two, a box
/// its corners and a mesh its vertices, with radius 0. That is enough to touch planes. Single balls touch each other
/// and polytopes; polytopes touch each other.
struct Collider {
  int body = kFixed;                 // moving body, or kFixed: then all is in the world
  std::vector<Vec3> points;          // m, from the centre of mass in the body's frame
  double radius = 0;                 // m
  double boundingRadius = 0;         // m, of all balls about the centre of mass
  std::optional<Polytope> polytope;  // same frame as the points
  Bounds bounds = {};                // m, of all balls; same frame as the points
  int surface = 0;                   // index into ContactGeometry::laws

  bool isBall() const { return points.size() == 1; }
};

/// A half-space that does not move.
struct PlaneCollider {
  Vec3 point = Vec3::Zero();    // m, world
  Vec3 normal = Vec3::UnitY();  // unit, out of the solid
  int surface = 0;              // index into ContactGeometry::laws
};

/// How two touching surfaces treat each other.
struct SurfaceLaw {
  double restitution = 0, staticFriction = 0, dynamicFriction = 0;
};

/// Two colliders that may touch.
struct ColliderPair {
  std::size_t a = 0, b = 0;  // indices into ContactGeometry: colliders; colliders or planes
  bool againstPlane = false;
  SurfaceLaw law;
};

/// Everything that may touch. Which of it is near changes as bodies move: see broad_phase.h.
struct ContactGeometry {
  std::vector<Collider> colliders;
  std::vector<PlaneCollider> planes;
  std::vector<std::vector<SurfaceLaw>> laws;                  // [surface][surface], symmetric
  std::vector<std::pair<std::size_t, std::size_t>> excluded;  // colliders a < b that do not touch each other; ascending
  std::vector<ColliderPair> pairs;                            // near each other now, in the order of BroadPhase
  std::vector<ColliderPair> unsolvedPairs;  // contact that cannot be computed: must stay out of each other's reach
};

}  // namespace cradle
