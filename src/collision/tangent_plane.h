#pragma once

#include "collision/mesh_surface.h"

namespace cradle {

// Whether a solid lies behind a plane through one of its vertices or edges: only there can others touch these. `ahead`
// (unit) is the plane's normal in the solid's frame; what is `margin` (m) ahead, or tilted by little, counts as behind,
// so that a face touches with all of its outline.

bool isForemost(const MeshSurface& surface, std::uint32_t vertex, const Vec3& ahead, double margin);

/// `ahead` is perpendicular to the edge.
bool isForemost(const MeshSurface& surface, const MeshSurface::Edge& edge, const Vec3& ahead, double margin);

/// How far ahead (m) a point may be at a distance `length` (m) of the one in the plane.
double allowedAhead(double margin, double length);

}  // namespace cradle
