#pragma once

#include "mesh/triangle_mesh.h"

namespace cradle {

/// Whether a closed mesh is connected and every vertex lies behind every face's plane, up to 1e-6 of the mesh's size.
/// O(triangles) for most meshes that are not, O(vertices x triangles) for those that are.
bool isConvex(const TriangleMesh& mesh);

}  // namespace cradle
