#pragma once

#include "collision/mesh_nearest.h"

namespace cradle {

/// How deep a piece of a straight edge is inside a solid, in the frame of the solid.
struct EdgeDepth {
  double depth = 0;             // m, >= 0: the way along `normal` that brings the edge out
  Vec3 normal = Vec3::Zero();   // unit, outwards
  Vec3 deepest = Vec3::Zero();  // m, on the edge
  bool isVertex = false;        // the deepest point is the edge's end, under a face
};

/// Of the piece of `edge` that begins where it goes through a face, at `part` (0..1) of its length, and lies inside:
/// at its end, or where the edge passes beneath another edge, by the distance of the two lines. Exact while the piece
/// meets no more than the faces at one edge or vertex; deeper inside, some way out. Of a sheet, what is behind it, seen
/// from the side of the face, counts as inside. O(log triangles).
EdgeDepth depthOfEdge(const MeshSurface& solid, const Segment& edge, double part, std::uint32_t face);

}  // namespace cradle
