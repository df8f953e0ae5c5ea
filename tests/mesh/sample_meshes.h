#pragma once

#include <functional>

#include "mesh/primitives.h"
#include "mesh/triangle_mesh.h"

// Meshes that several tests use.

namespace cradle {

/// What physics sees of a drawn mesh.
inline TriangleMesh solidOf(const DrawnMesh& drawn) {
  return weld(drawn.vertices, drawn.triangles);
}

inline TriangleMesh boxMesh(const Vec3& size) {
  return solidOf(tessellate(Box{size}));
}

inline TriangleMesh moved(TriangleMesh mesh, const std::function<Vec3(const Vec3&)>& move) {
  for (Vec3& vertex : mesh.vertices) vertex = move(vertex);
  return mesh;
}

/// Two meshes as one, not welded.
inline TriangleMesh joined(TriangleMesh mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  return mesh;
}

inline TriangleMesh insideOut(TriangleMesh mesh) {
  for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

/// The prism over a regular polygon of `corners` corners on a circle, along y, centred.
inline TriangleMesh prismMesh(int corners, double radius, double length) {
  return solidOf(tessellate(Cylinder{radius, length}, corners));
}

/// An L of 3 x 2 squares without its upper right 2 x 1, one deep; a corner is the origin.
inline TriangleMesh lPrismMesh() {
  TriangleMesh mesh;
  for (const double z : {0, 1})
    for (const auto& [x, y] : {std::pair{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 2}, {0, 2}})
      mesh.vertices.emplace_back(x, y, z);
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    mesh.triangles.insert(mesh.triangles.end(), {{i, j, 6 + j}, {i, 6 + j, 6 + i}});
  }
  for (std::uint32_t i = 1; i < 5; ++i) mesh.triangles.insert(mesh.triangles.end(), {{0, i + 1, i}, {6, 6 + i, 7 + i}});
  return mesh;
}

/// A turned and shifted placement without any symmetry.
inline RigidTransform askew() {
  return {Quat(0.5, -0.3, 0.7, 0.2).normalized(), Vec3(0.7, -1.3, 2.1)};
}

}  // namespace cradle
