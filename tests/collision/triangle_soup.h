#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "collision/closest_points.h"
#include "collision/random_poses.h"
#include "mesh/sample_meshes.h"

// Meshes without symmetry, and what is known of them from every single triangle, without trees or features.

namespace cradle {

/// Ground of 4 x 4 squares of 1 m whose inner corners are lifted at random; two of the squares stay in one plane.
inline TriangleMesh crumpledSheet(unsigned seed) {
  RandomPoses random(seed);
  TriangleMesh mesh;
  for (int i = 0; i <= 4; ++i)
    for (int k = 0; k <= 4; ++k) mesh.vertices.emplace_back(i, i > 0 ? random.number(-0.5, 0.5) : 0.0, k);
  for (std::uint32_t i = 0; i < 4; ++i)
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t at = 5 * i + k;
      mesh.triangles.push_back({at, at + 1, at + 6});
      // Not wound alike: a sheet need not be.
      mesh.triangles.push_back((i + k) % 2 ? Triangle{at, at + 6, at + 5} : Triangle{at, at + 5, at + 6});
    }
  return mesh;
}

inline double distanceTo(const TriangleMesh& mesh, const Triangle& triangle, const Vec3& point) {
  const Vec3 &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]], &c = mesh.vertices[triangle[2]];
  const FlatTriangle flat{a, b, c, (b - a).cross(c - a).normalized()};
  double least = flat.isAbove(point) ? std::abs(flat.heightOf(point)) : INFINITY;
  for (std::size_t i = 0; i < 3; ++i) {
    const Segment side{cornerOf(flat, i), cornerOf(flat, (i + 1) % 3) - cornerOf(flat, i)};
    least = std::min(least, (point - side.at(side.nearestPart(point))).norm());
  }
  return least;
}

inline double distanceTo(const TriangleMesh& mesh, const Vec3& point) {
  double least = INFINITY;
  for (const Triangle& triangle : mesh.triangles) least = std::min(least, distanceTo(mesh, triangle, point));
  return least;
}

using Corners = std::array<Vec3, 3>;

inline std::vector<Corners> cornersOf(const TriangleMesh& mesh, const RigidTransform& pose) {
  std::vector<Corners> all;
  for (const auto& [i, j, k] : mesh.triangles)
    all.push_back({pose * mesh.vertices[i], pose * mesh.vertices[j], pose * mesh.vertices[k]});
  return all;
}

/// How often a closed surface winds around a point: 1 inside, 0 outside (A. Van Oosterom, J. Strackee, "The solid angle
/// of a plane triangle", 1983).
inline double windingAround(const Vec3& p, const std::vector<Corners>& surface) {
  double angle = 0;
  for (const Corners& t : surface) {
    const Vec3 a = t[0] - p, b = t[1] - p, c = t[2] - p;
    angle += 2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                   b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return angle / (4 * M_PI);
}

/// A ball whose vertices are pushed in and out: concave, without any symmetry.
inline TriangleMesh lumpMesh(RandomPoses& random) {
  TriangleMesh mesh = solidOf(tessellate(Sphere{0.6}, 8));
  for (Vec3& vertex : mesh.vertices) vertex *= random.number(0.5, 1.3);
  return mesh;
}

}  // namespace cradle
