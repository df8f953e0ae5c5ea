#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "collision/bvh.h"
#include "mesh/triangle_mesh.h"

namespace cradle {

/// The surface of a solid of triangles, prepared for contact: who is next to whom, which way is out, and a tree to find
/// triangles by. In the mesh's frame. A sheet is a solid of thickness zero: each of its triangles is there twice, once
/// for each side, and the two sides meet at its borders.
struct MeshSurface {
  struct Face {
    std::array<std::uint32_t, 3> vertices;
    std::array<std::uint32_t, 3> edges;  // i: from vertex i to the next
    Vec3 normal;                         // unit, outwards; zero if the triangle has no area
    // Each edge and vertex belongs to one of its triangles, so that pairs of triangles meet it once.
    std::array<bool, 3> ownsVertex, ownsEdge;
  };
  struct Edge {
    std::array<std::uint32_t, 2> vertices;
    std::array<std::uint32_t, 2> across;      // the third vertices of its two triangles
    Vec3 normal;                              // unit, outwards: mean of the triangles', at a border along the sheet
    bool isConvex;                            // the solid's angle is below 180 degrees: other edges can touch it
    std::array<std::uint32_t, 2> faces = {};  // its two triangles
    bool isBorder = false;                    // of a sheet: both are one triangle's sides
    bool isBent = true;                       // its triangles are not in one plane, to rounding
  };

  std::vector<Vec3> vertices;  // m
  std::vector<Vec3>
      vertexNormals;  // unit, outwards: mean of the triangles' weighted by angle; zero at borders of sheets
  std::vector<std::uint32_t> neighbours;      // vertices at the other ends of a vertex's edges,
  std::vector<std::uint32_t> firstNeighbour;  // from firstNeighbour[v] to firstNeighbour[v + 1]
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<std::uint32_t> parts;  // a vertex of each connected part
  // Flat regions: connected triangles in one plane. That of each face, and the edges around each: of region r
  // borders[firstBorder[r]] to borders[firstBorder[r + 1]].
  std::vector<std::uint32_t> regions, borders, firstBorder;
  std::optional<Vec3> inner = {};  // m: a point inside, of a convex solid
  bool isSheet = false;            // nothing is inside
  double size = 0;                 // m: diagonal of the box around all
  double edgeLength = 0;           // m: mean of all edges
  Bvh tree;
};

/// The mesh must be closed, two triangles at each edge in opposite directions, wound counter-clockwise seen from
/// outside. O(n log^2 n).
MeshSurface surfaceOf(const TriangleMesh& mesh);

/// Both sides of a mesh that need not be closed, nor wound alike: terrain, a lampshade. Indices in range. O(n log^2 n).
MeshSurface sheetOf(const TriangleMesh& mesh);

}  // namespace cradle
