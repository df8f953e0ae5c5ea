#pragma once

#include <limits>

#include "collision/closest_points.h"
#include "collision/mesh_surface.h"

namespace cradle {

/// The point of a surface nearest to a given one, in the mesh's frame.
struct MeshPoint {
  enum class Feature { none, face, edge, vertex };
  Feature feature = Feature::none;                             // none: nothing is as near as asked
  std::uint32_t index = 0;                                     // of the feature
  Vec3 point = Vec3::Zero();                                   // m
  Vec3 normal = Vec3::Zero();                                  // unit, outwards: the feature's
  double distance2 = std::numeric_limits<double>::infinity();  // m^2, of the squares
};

/// Lengths (m) below which places on a surface are the same, from the size of the surface (of the smaller of two).
struct MeshTolerances {
  explicit MeshTolerances(double size) : rounding(1e-12 * size), inPlane(1e-9 * size) {}

  double rounding;  // 1e4 unit roundoffs: errors of nearest points on triangles with angles down to 1e-4 rad
  double inPlane;   // points no farther ahead of a plane are in it, as in flat regions (kFlatRatio in mesh_surface.cpp)
};

/// Of all points nearer than `reach` (m). O(log triangles) for points near the surface.
MeshPoint nearestPoint(const MeshSurface& surface, const Vec3& point,
                       double reach = std::numeric_limits<double>::infinity());

/// A distance, < 0 inside, and which way is out.
struct SignedHeight {
  double height = 0;            // m
  Vec3 normal = Vec3::Zero();   // unit, outwards
  Vec3 nearest = Vec3::Zero();  // m, on the surface
  MeshPoint::Feature feature = MeshPoint::Feature::none;
};

/// Of a point over the surface. Exact on both sides; nothing is inside a sheet.
SignedHeight heightOver(const MeshSurface& surface, const Vec3& point);

/// Corners and normal of a face.
inline FlatTriangle triangleOf(const MeshSurface& surface, std::uint32_t face) {
  const MeshSurface::Face& corners = surface.faces[face];
  return {surface.vertices[corners.vertices[0]], surface.vertices[corners.vertices[1]],
          surface.vertices[corners.vertices[2]], corners.normal};
}

inline Segment segmentOf(const MeshSurface& surface, std::uint32_t edge) {
  const auto& [from, to] = surface.edges[edge].vertices;
  return {surface.vertices[from], surface.vertices[to] - surface.vertices[from]};
}

}  // namespace cradle
