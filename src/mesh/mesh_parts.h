#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace cradle {

/// A connected component of a closed surface: triangles that hang together by their edges.
struct MeshPart {
  std::vector<std::uint32_t> triangles;  // of the mesh, ascending
  Bounds bounds;                         // m
  double volume = 0;                     // m^3; < 0: inside-out, or a cavity; 0: flat
};

/// The parts of a mesh in which every edge is shared by two triangles, in the order of their first triangles.
/// O(n log n).
std::vector<MeshPart> partsOf(const TriangleMesh& mesh);

/// How the parts of a closed surface lie to each other. A solid's surface has its volume on the inner side everywhere:
/// its outermost parts face outwards, a part inside of one is a cavity and faces inwards, an island in a cavity faces
/// outwards again, and so on; no parts cross.
struct PartReport {
  std::vector<MeshPart> parts;
  std::vector<std::size_t> insideOut;  // parts that are to be turned, ascending
  std::vector<std::string> overlaps;   // sentences: which parts overlap, and where
};

/// Parts that touch do not overlap: up to 1e-6 of the smaller one, or what single precision leaves of coordinates. Of a
/// mesh that came inside-out as a whole, cavities are to be turned with the parts around them. About O(n log n) for
/// parts that lie side by side, O(n) more for each pair whose bounds overlap.
PartReport examineParts(const TriangleMesh& mesh);

/// "part 2 of 3 (12 triangles around (0, 1, 0))".
std::string describePart(const PartReport& report, std::size_t part);

}  // namespace cradle
