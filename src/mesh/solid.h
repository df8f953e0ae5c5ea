#pragma once

#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace cradle {

/// Whether a mesh bounds a volume, and if not, what is wrong with it.
struct SolidReport {
  bool isSolid = false;  // every edge is shared by exactly two triangles in opposite directions, volume > 0
  std::vector<std::string> problems;  // sentences: how many edges are open or non-manifold, where the first is, ...
  std::vector<std::string> notes;     // what was mended or passed over: degenerate triangles dropped, turned outside-in
};

/// Checks `mesh` (finite vertices, indices in range). O(n log n).
SolidReport checkSolid(const TriangleMesh& mesh);

}  // namespace cradle
