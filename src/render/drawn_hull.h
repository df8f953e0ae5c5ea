#pragma once

#include <array>
#include <optional>
#include <vector>

#include "render/draw_list.h"
#include "render/render_setup.h"

namespace cradle {

/// The convex hull of spheres of one radius, around what is drawn of an item.
struct DrawnHull {
  std::array<Vec3, 16> centers = {};  // m, world
  std::size_t count = 0;
  double radius = 0;  // m

  void add(const Vec3& center) { centers[count++] = center; }
  Vec3 middle() const;
  Bounds bounds() const;  // m, world
  /// Of a sphere around the middle that contains all.
  double reach() const;
};

/// A triangle of a mesh that is long beside the mesh.
struct LongTriangle {
  std::uint32_t index = 0;
  std::array<Vec3, 3> corners;  // m, mesh's frame, counter-clockwise from outside
};

/// Triangles that are near each other and face about the same way.
struct TriangleGroup {
  std::uint32_t first = 0, last = 0;  // the least and the greatest of their indices
  Bounds box;                         // m, mesh's frame
  Vec3 normal = Vec3::Zero();         // unit, outwards: in the middle of theirs
  double normalSpread = 0;            // greatest distance of theirs from it
};

/// Where a mesh's triangles are, in its frame.
struct MeshBounds {
  Bounds whole;
  std::vector<Bounds> runs;                 // of kTrianglesPerRun triangles each
  std::vector<TriangleGroup> groups;        // of all but the long ones
  std::vector<LongTriangle> longTriangles;  // in order
  bool isClosed = false;                    // then its inside is never seen
  double normalError = 0;                   // greatest distance of a unit normal from the direction out of the middle
};
constexpr std::uint32_t kTrianglesPerRun = 64;
MeshBounds boundsOf(const DrawnMesh& mesh, bool isClosed);

DrawnHull hullOf(const Bounds& local, const RigidTransform& worldFromLocal);
DrawnHull hullOf(const SphereItem& item);
DrawnHull hullOf(const CylinderItem& item);
DrawnHull hullOf(const TubeItem& item);

/// What a hull passes on its way from `first` to `last` (m, world); of at most eight centres.
DrawnHull swept(const DrawnHull& hull, const Vec3& first, const Vec3& last);

/// Points in the picture (pixels from the lower left corner) whose convex hull contains what is seen of a hull; none if
/// part of it is not in front of the camera.
std::optional<std::vector<Eigen::Vector2d>> outlineOf(const DrawnHull& hull, const RenderSetup& setup);

/// The same of a polygon (m, world).
std::optional<std::vector<Eigen::Vector2d>> outlineOf(const std::vector<Vec3>& polygon, const RenderSetup& setup);

}  // namespace cradle
