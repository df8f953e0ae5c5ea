// Vertices are joined only where they are bit-equal. A distance that counts as "equal" would have to be guessed, and a
// wrong guess closes gaps that are meant, or collapses small models.

#include "mesh/triangle_mesh.h"

#include <algorithm>

#include "mesh/number_distinct.h"

namespace cradle {

std::size_t nearestVertex(const std::vector<Vec3>& vertices, const Vec3& point) {
  const auto isNearer = [&](const Vec3& a, const Vec3& b) {
    return (a - point).squaredNorm() < (b - point).squaredNorm();
  };
  return static_cast<std::size_t>(std::min_element(vertices.begin(), vertices.end(), isNearer) - vertices.begin());
}

TriangleMesh weld(const std::vector<Vec3>& vertices, const std::vector<Triangle>& triangles) {
  const Numbering numbering = numberPositions(vertices);

  TriangleMesh mesh;
  mesh.vertices.reserve(numbering.firstKey.size());
  for (const std::uint32_t first : numbering.firstKey)
    mesh.vertices.push_back(vertices[first] + Vec3::Zero());  // -0 becomes 0
  mesh.triangles.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    const Triangle welded{numbering.numberOf[a], numbering.numberOf[b], numbering.numberOf[c]};
    if (welded[0] != welded[1] && welded[1] != welded[2] && welded[2] != welded[0]) mesh.triangles.push_back(welded);
  }
  return mesh;
}

}  // namespace cradle
