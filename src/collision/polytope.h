#pragma once

#include <cstddef>
#include <vector>

#include "math/types.h"
#include "mesh/convex_hull.h"
#include "mesh/primitives.h"

namespace cradle {

/// A convex solid with flat faces, in a frame of its own. A segment is one without faces.
struct Polytope {
  struct Face {
    Vec3 normal;                    // unit, outwards
    double offset;                  // m, the largest normal . x of all vertices
    std::vector<std::size_t> loop;  // vertices, counter-clockwise seen from outside
  };
  struct Edge {
    std::size_t from, to;     // vertices
    std::size_t left, right;  // faces; the left one's loop runs from `from` to `to`
  };

  std::vector<Vec3> vertices;  // m
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<std::size_t> firstNeighbor;  // of each vertex, and the end: ranges of `neighbors` and of `edgesAt`
  std::vector<std::size_t> neighbors;      // vertices at the other ends of a vertex's edges
  std::vector<std::size_t> edgesAt;        // those edges; of a segment none
};

/// Of a closed convex surface.
Polytope polytopeOf(const ConvexHull& hull);

/// `frameFromBox` places the box's centre and axes.
Polytope polytopeOf(const Box& box, const RigidTransform& frameFromBox);

/// The prism of 16 sides with its corners on the rims.
Polytope inscribedPrism(const Cylinder& cylinder, const RigidTransform& frameFromCylinder);

Polytope segmentBetween(const Vec3& from, const Vec3& to);

/// Index of the vertex farthest along `direction`; the search starts at vertex `start`.
std::size_t supportVertex(const Polytope& polytope, const Vec3& direction, std::size_t start = 0);

/// Nearest point of a solid's surface.
struct SurfacePoint {
  double distance = 0;          // m, < 0 inside
  Vec3 nearest = Vec3::Zero();  // m
  Vec3 normal = Vec3::UnitY();  // unit, outwards there; from `nearest` to the point if that is outside
  double radius = 0;            // m, as in ContactPoint: infinite on a face, NaN on an edge, 0 at a corner
};

/// Of a point in the polytope's frame. Exact, inside and outside. O(faces).
SurfacePoint nearestSurfacePoint(const Polytope& polytope, const Vec3& point);

}  // namespace cradle
