#pragma once

#include <vector>

#include "render/appearance.h"
#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Some triangles of a mesh, placed in the world.
struct MeshItem {
  int mesh = 0;  // index into Appearance::meshes
  std::uint32_t firstTriangle = 0, triangleCount = 0;
  RigidTransform worldFromMesh = {};
  Surface surface = {};
  bool isSphere = false;
  Bounds bounds = {};                            // m, world
  int firstNearOccluder = 0, nearOccluders = 0;  // range of DrawList::nearOccluders
};

/// A sphere that is drawn exactly round.
struct SphereItem {
  Vec3 center;  // m, world
  double radius = 0;
  Surface surface = {};
  int firstNearOccluder = 0, nearOccluders = 0;  // range of DrawList::nearOccluders
  Quat rotation = Quat::Identity();              // worldFromBody, of a pattern
  std::optional<LinkKind> link = {};             // whose it is, unless a body's or an arrow's
  Bounds bounds() const { return {center - Vec3::Constant(radius), center + Vec3::Constant(radius)}; }
};

/// A cylinder that is drawn exactly round: a body, or a rod.
struct CylinderItem {
  Vec3 center;  // m, world
  Vec3 axis;    // unit
  double radius = 0, length = 0;
  Surface surface = {};
  int firstNearOccluder = 0, nearOccluders = 0;  // range of DrawList::nearOccluders
  Vec3 side = Vec3::UnitX();                     // unit, across the axis: the body's x axis, of a pattern
  std::optional<LinkKind> link = {};             // as of a sphere
  Bounds bounds() const;
};

constexpr int kMaxCoilTurns = 40;

/// A round tube along a curve: a spring's coil, or a rope that sags.
struct TubeItem {
  Vec3 start, end;        // m, world
  Vec3 side;              // unit, across the line from start to end
  double wireRadius = 0;  // m, of the tube
  double coilRadius = 0;  // m, of the coil; 0 for a rope
  int turns = 0;
  double straightEnd = 0;   // share of the length that is straight at each end
  Vec3 sag = Vec3::Zero();  // m, from the line's middle to the rope's
  double slack = 0;         // of a rope: half its span in units of the catenary's parameter; 0 if it is straight
  double lean = 0;          // of a rope: rise of its end over its length
  Surface surface = {};
  Bounds bounds = {};                 // m, world
  std::optional<LinkKind> link = {};  // as of a sphere
};

// Facets of tubes: the chords of a coil miss its circle by 1 % of its radius.
constexpr int kSegmentsPerTurn = 20, kRopeSegments = 64, kSegmentsAround = 10;

constexpr double kSphereReach = 3;  // radii from a sphere's centre: beyond, it is not mirrored and shades nothing
constexpr double kBoxReach = 1.6;   // middle half edges from a box's surface

/// A sphere or box that surfaces near it mirror (local reflections), and that keeps the sky's light from them (ambient
/// occlusion).
struct OccluderItem {
  Vec3 center;        // m, world
  double radius = 0;  // of a sphere, m; of a box, how far it reaches beyond its surface
  Surface surface = {};
  int body = 0;
  Vec3 half = Vec3::Zero();          // half edges of a box, m; zero for a sphere
  Quat rotation = Quat::Identity();  // worldFromBox
  bool isSphere() const { return half.isZero(0); }
  /// Of all that it influences; m, world.
  Bounds reach() const;
};

/// A body, or a part of it, whose contact shadow darkens the ground: the ambient occlusion of a box, or of an ellipsoid
/// or cylinder in it.
struct ContactShadowItem {
  RigidTransform worldFromBox;
  Vec3 half;  // m, half edges of the box around it
  ContactShadowShape kind = ContactShadowShape::box;
};

/// A picture as plain data, in a fixed order: OpenGL comes after.
struct DrawList {
  std::vector<MeshItem> meshes;  // grouped by mesh, range and texture
  std::vector<MeshItem> walls;   // planes other than the ground; throw no shadow, for light comes in through them
  std::vector<SphereItem> spheres;
  std::vector<CylinderItem> cylinders;
  std::vector<TubeItem> tubes;  // springs before ropes
  std::vector<OccluderItem> occluders;
  std::vector<int> nearOccluders;  // indices into occluders
  std::vector<ContactShadowItem> contactShadows;
};

/// A frame, and from where it is seen (m, world).
struct SeenFrame {
  const Frame& frame;
  Vec3 viewpoint;
};

/// A plane other than the ground, as a square next to what is shown; none from behind, where it is not there, nor of
/// another body.
std::optional<MeshItem> wallOf(const Scene& scene, const Appearance& appearance, const View& view, std::size_t body,
                               const Vec3& viewpoint);

/// What is to be drawn. Items stand in the order of the scene. O(bodies x spheres).
DrawList makeDrawList(const Scene& scene, const Appearance& appearance, const View& view, const SeenFrame& seen);

}  // namespace cradle
