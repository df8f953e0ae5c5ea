#pragma once

#include <cstdint>
#include <vector>

#include "mesh/number_distinct.h"
#include "mesh/triangle_mesh.h"

namespace cradle {

/// Which neighbours a triangle is smooth with: bits of 3ds smoothing groups (0: none), or what its file does not say.
using Smoothing = std::int64_t;
constexpr Smoothing kSmoothingUnknown = -1;

/// Unit normal of a triangle of `mesh`; zero if its corners are in line.
Vec3 triangleNormal(const DrawnMesh& mesh, const Triangle& triangle);

/// Gives each corner whose normal is zero the mean normal, weighted by angle, of the triangles at its position that its
/// own is smooth with: they share a smoothing group; where unknown, they are less than 40 degrees apart, so that round
/// things look smooth and edges stay sharp. Vertices 3 t, 3 t + 1 and 3 t + 2 must be the corners of triangle t;
/// `smoothing` has an entry for each triangle, `positions` numbers the vertices' positions. O(n) times the triangles at
/// a position, 256 at most: of more, normals that differ by less than 2 degrees count as one.
void fillMissingNormals(const std::vector<Smoothing>& smoothing, const Numbering& positions, DrawnMesh& mesh);

}  // namespace cradle
