#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "collision/polytope.h"
#include "dynamics/rigid_body.h"

namespace cradle {

struct MeshSurface;
class FeatureNeighbourList;

/// A place of a body that a joint keeps where it is on another body, or on all that is fixed: its anchor, and with a
/// hinge all of the axis through it. Surfaces that touch each other there can neither part nor close.
struct PinnedPlace {
  int other = kFixed;         // moving body that it is joined to, or kFixed
  Vec3 point = Vec3::Zero();  // m, from the centre of mass in the body's frame
  Vec3 axis = Vec3::Zero();   // unit, body's frame: of a hinge; zero: a ball joint
};

enum class ColliderKind { sphere, capsule, cylinder, polytope, mesh };

/// The shape of a body for contact: a core, and a sphere of `radius` around each of its points. The core of a sphere is
/// a point, that of a capsule a segment; boxes and hulls are polytopes, cylinders are all between two discs, and these
/// and meshes have no spheres around them.
struct Collider {
  int body = kFixed;          // moving body, or kFixed: then all is in the world
  std::vector<Vec3> points;   // m, from the centre of mass in the body's frame: centre, ends, or vertices
  double radius = 0;          // m
  double boundingRadius = 0;  // m, of the whole about the centre of mass
  // Same frame; of a capsule its segment, of a cylinder a prism inside it. Shared by all copies.
  std::shared_ptr<const Polytope> polytope = {};
  Bounds bounds = {};    // m, of the whole; same frame as the points
  int surface = 0;       // index into ContactGeometry::laws
  double rimRadius = 0;  // m, > 0: of the discs around both points of a cylinder
  std::shared_ptr<const MeshSurface> mesh =
      {};  // of a mesh, shared by all bodies of a model; of a polytope that meets meshes
  RigidTransform bodyFromMesh = {};
  std::vector<PinnedPlace> pins = {};
  bool isDriven = false;  // its body moves, but no force moves it

  bool isHeld() const { return body == kFixed || isDriven; }  // no force moves it
  bool isSphere() const { return points.size() == 1; }
  ColliderKind kind() const {
    if (rimRadius > 0) return ColliderKind::cylinder;
    if (points.size() > 2) return polytope ? ColliderKind::polytope : ColliderKind::mesh;
    return isSphere() ? ColliderKind::sphere : ColliderKind::capsule;
  }
};

/// Colliders of the shapes that primitives and hulls have, placed in the body's frame. `body` and `surface` are left.
Collider colliderOf(const Sphere& sphere, const RigidTransform& bodyFromShape);
Collider colliderOf(const Box& box, const RigidTransform& bodyFromShape);
Collider colliderOf(const Cylinder& cylinder, const RigidTransform& bodyFromShape);
Collider colliderOf(const Capsule& capsule, const RigidTransform& bodyFromShape);
Collider colliderOf(const ConvexHull& hull, const RigidTransform& bodyFromShape);

/// Whether a joint with body `other` keeps a point of a collider (m, its frame) where it is, to `tolerance` (m) however
/// the body turns.
bool isPinned(const Collider& collider, int other, const Vec3& point, double tolerance);

/// Of a point in the collider's frame. Exact, inside and outside.
SurfacePoint nearestSurfacePoint(const Collider& collider, const Vec3& point);

/// A half-space that does not move.
struct PlaneCollider {
  Vec3 point = Vec3::Zero();    // m, world
  Vec3 normal = Vec3::UnitY();  // unit, out of the solid
  int surface = 0;              // index into ContactGeometry::laws
};

/// How two touching surfaces treat each other.
struct ContactMaterial {
  double restitution = 0, staticFriction = 0, dynamicFriction = 0;
};

/// Two colliders that may touch.
struct ColliderPair {
  std::size_t a = 0, b = 0;  // indices into ContactGeometry: colliders; colliders or planes
  bool againstPlane = false;
  ContactMaterial material;
  std::shared_ptr<FeatureNeighbourList> near =
      {};  // of two surfaces: for all searches of the pair, by one thread at a time
};

/// Everything that may touch. Which of it is near changes as bodies move: see broad_phase.h.
struct ContactGeometry {
  std::vector<Collider> colliders;
  std::vector<PlaneCollider> planes;
  std::vector<std::vector<ContactMaterial>> materials;        // [surface][surface], symmetric
  std::vector<std::pair<std::size_t, std::size_t>> excluded;  // colliders a < b that do not touch each other; ascending
  std::vector<ColliderPair> pairs;                            // near each other now, in the order of BroadPhase
  std::vector<ColliderPair> unsolvedPairs;  // contact that cannot be computed: must stay out of each other's reach
};

/// Radius (m), > 0, of a sphere inside a collider: around the centre of its bounds, or the mean of its corners where
/// that is deeper inside, as in wedges and pyramids; of a mesh at least its volume by its surface's area; infinite of a
/// sheet, which nothing is inside of.
double innerRadius(const Collider& collider);

/// The least bounding radius (m) of what moves; 1 if nothing does.
double smallestSize(const ContactGeometry& geometry);

}  // namespace cradle
