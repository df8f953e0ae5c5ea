#pragma once

#include <vector>

#include "collision/mesh_nearest.h"

namespace cradle {

// Where a sphere touches a mesh: on a flat region of its surface (index: one of its faces), an edge or a vertex. All
// points and distances are in the mesh's frame (m).

/// A feature, and which way it looks: what touches it is ahead.
struct TouchedFeature {
  MeshPoint::Feature feature = MeshPoint::Feature::none;
  std::uint32_t index = 0;
};

/// Distance (m) of a point inside the Voronoi region of a feature, where that is the nearest of the features that meet
/// at it, from the border of the region; < 0 outside. Changes no faster than the point moves. O(borders of the flat
/// region).
double insideRegion(const MeshSurface& surface, const TouchedFeature& touched, const Vec3& point);

/// Width (m) of the strip along the border of a region in which a contact may be found on either side.
double borderWidth(const MeshSurface& surface);

/// A half-space behind a feature: normal . x <= offset. Points in all half-spaces of a feature are no nearer than the
/// feature itself to a sphere that stays on it.
struct HalfSpace {
  Vec3 normal = Vec3::Zero();  // unit
  double offset = 0;           // m
};
std::vector<HalfSpace> spaceBehind(const MeshSurface& surface, const TouchedFeature& touched);

/// Distance (m) of a point from those triangles that are not wholly behind any one of the features; infinite if above
/// `reach` (m).
double distanceBeside(const MeshSurface& surface, const std::vector<std::vector<HalfSpace>>& touched, const Vec3& point,
                      double reach);

}  // namespace cradle
