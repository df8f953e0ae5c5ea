#pragma once

#include "mesh/triangle_mesh.h"

namespace cradle {

/// Whether every vertex of a closed mesh lies behind every face's plane, up to 1e-6 of the mesh's size
/// and the turns of planes by vertices that are off by `slack` (m). (Two parts never do: each has vertices in front of
/// the other's planes.) O(triangles) for most meshes that are not, O(vertices x triangles) for those that are.
bool isConvex(const TriangleMesh& mesh, double slack = 0);

}  // namespace cradle
