#pragma once

#include <cstddef>
#include <vector>

#include "math/types.h"
#include "mesh/primitives.h"

namespace cradle {

/// A convex solid with flat faces, in a frame of its own.
struct Polytope {
  struct Face {
    Vec3 normal;                    // unit, outwards
    double offset;                  // m, normal . x on the face
    std::vector<std::size_t> loop;  // vertices, counter-clockwise seen from outside
  };
  struct Edge {
    std::size_t from, to;  // vertices
  };

  std::vector<Vec3> vertices;  // m
  std::vector<Face> faces;
  std::vector<Edge> edges;
  std::vector<Vec3> edgeDirections;  // unit; each direction once, whatever its sign
};

/// `frameFromBox` places the box's centre and axes.
Polytope polytopeOf(const Box& box, const RigidTransform& frameFromBox);

/// Nearest point of a polytope's surface.
struct SurfacePoint {
  double distance = 0;          // m, < 0 inside
  Vec3 nearest = Vec3::Zero();  // m
  Vec3 normal = Vec3::UnitY();  // unit, outwards there; from `nearest` to the point if that is outside
  double radius = 0;            // m: infinite on a face, NaN on an edge, 0 at a corner
};

/// Of a point in the polytope's frame. Exact, inside and outside. O(vertices).
SurfacePoint nearestSurfacePoint(const Polytope& polytope, const Vec3& point);

}  // namespace cradle
