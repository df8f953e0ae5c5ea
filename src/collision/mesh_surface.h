#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "collision/triangle_tree.h"
#include "mesh/triangle_mesh.h"

namespace cradle {

/// The surface of a closed solid of triangles, prepared for contact: who is next to whom, which way is out, and a tree
/// to find triangles by. In the mesh's frame.
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
    std::array<std::uint32_t, 2> across;  // the third vertices of its two triangles
    Vec3 normal;                          // unit, outwards: mean of the triangles'
    bool isConvex;                        // the solid's angle is below 180 degrees: other edges can touch it
  };

  std::vector<Vec3> vertices;                 // m
  std::vector<Vec3> vertexNormals;            // unit, outwards: mean of the triangles' weighted by angle
  std::vector<std::uint32_t> neighbours;      // vertices at the other ends of a vertex's edges,
  std::vector<std::uint32_t> firstNeighbour;  // from firstNeighbour[v] to firstNeighbour[v + 1]
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<std::uint32_t> parts;  // a vertex of each connected part
  double size = 0;                   // m: diagonal of the box around all
  TriangleTree tree;
};

/// The mesh must be closed, two triangles at each edge in opposite directions, wound counter-clockwise seen from
/// outside. O(n log^2 n).
MeshSurface surfaceOf(const TriangleMesh& mesh);

}  // namespace cradle
