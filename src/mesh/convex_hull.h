#pragma once

#include <cstddef>
#include <vector>

#include "math/types.h"
#include "mesh/triangle_mesh.h"

namespace cradle {

/// The convex hull of a set of points. Faces that are one plane, up to 1e-6 of the size, are one polygon.
struct ConvexHull {
  std::vector<Vec3> vertices;                   // m: some of the points, in their order
  std::vector<std::vector<std::size_t>> faces;  // loops of vertices, counter-clockwise seen from outside
};

/// The triangles of a hull, its faces as fans.
TriangleMesh trianglesOf(const ConvexHull& hull);

/// Throws Error(mesh) if the points lie in a plane, up to 1e-6 of their size, or are fewer than four. O(n log n).
ConvexHull convexHullOf(const std::vector<Vec3>& points);

}  // namespace cradle
