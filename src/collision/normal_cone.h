#pragma once

#include "collision/mesh_surface.h"

namespace cradle {

// Whether a direction is in the normal cone of a vertex or edge of a solid: whether the solid lies behind the plane
// through that feature with the direction as its normal. Only from there can another body touch the feature (Gauss map:
// D. Gregorius, "The Separating Axis Test between Convex Polyhedra", GDC 2013). Contacts of inner edges of a mesh,
// which are in no cone, are left out by it. `ahead` (unit) is the plane's normal in the solid's frame; what is `margin`
// (m) ahead, or tilted by little, counts as behind, so that a face touches with all of its outline.

bool isInNormalCone(const MeshSurface& surface, std::uint32_t vertex, const Vec3& ahead, double margin);

/// Whether that may be so with any margin for a direction that differs from `ahead` by at most `tilt` (rad).
bool mayBeInNormalCone(const MeshSurface& surface, std::uint32_t vertex, const Vec3& ahead, double tilt);

/// `ahead` is perpendicular to the edge.
bool isInNormalCone(const MeshSurface& surface, const MeshSurface::Edge& edge, const Vec3& ahead, double margin);

/// How far ahead (m) a point may be at a distance `length` (m) of the one in the plane.
double allowedAhead(double margin, double length);

}  // namespace cradle
