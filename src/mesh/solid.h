#pragma once

#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace cradle {

/// Whether a mesh bounds a volume, and if not, what is wrong with it.
struct SolidReport {
  bool isClosed = false;  // every edge is shared by exactly two triangles in opposite directions, volume > 0
  bool isSolid = false;   // closed, and the volume is that of one solid: no part is inside-out, no two overlap
  std::vector<std::string> problems;  // sentences: how many edges are open or non-manifold, where the first is, ...
  std::vector<std::string> notes;     // what was mended or passed over: degenerate triangles dropped, turned outside-in
};

/// Whether every edge of a mesh is shared by exactly two triangles in opposite directions. O(n log n).
bool hasMatchingEdges(const TriangleMesh& mesh);

/// Checks `mesh` (finite vertices, indices in range). O(n log n), and what examineParts takes if it has several parts.
SolidReport checkSolid(const TriangleMesh& mesh);

}  // namespace cradle
