// J. A. Baerentzen, H. Aanaes, "Signed distance computation using the angle weighted pseudonormal", IEEE Trans.
// Visualization and Computer Graphics 11(3), 2005: with the mean normal of an edge's triangles, and the mean weighted
// by angle of a vertex's, the sign of (point - nearest point) . normal says exactly whether a point is inside.

#include "collision/mesh_surface.h"

#include <algorithm>
#include <utility>

#include "core/error.h"

namespace cradle {
namespace {

constexpr double kFlatPart = 1e-9;  // of the length: a bend by less is rounding of the vertices

/// Angle (rad) between two unit vectors, good to 1e-7: halved four times it is below pi / 16, where the series of the
/// arc sine suffices.
double angleBetween(const Vec3& a, Vec3 b) {
  for (int i = 0; i < 4; ++i) b = (a + b).normalized();
  const double sine = a.cross(b).norm(), square = sine * sine;
  return 16 * sine * (1 + square / 6 * (1 + square * 9 / 20 * (1 + square * 25 / 42)));
}

/// A side of a triangle: edges are where two of them lie together.
struct Side {
  std::uint32_t low, high, face, corner;  // vertices in order of number; the side begins at the face's corner

  bool isBefore(const Side& other) const {
    return std::array{low, high, face} < std::array{other.low, other.high, other.face};
  }
};

std::vector<Side> sortedSides(const MeshSurface& surface) {
  std::vector<Side> sides;
  for (std::uint32_t face = 0; face < surface.faces.size(); ++face)
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t from = surface.faces[face].vertices[i], to = surface.faces[face].vertices[(i + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), face, i});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& left, const Side& right) { return left.isBefore(right); });
  return sides;
}

void addFaces(const TriangleMesh& mesh, MeshSurface& surface) {
  std::vector<char> isOwned(mesh.vertices.size(), 0);
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3& first = mesh.vertices[triangle[0]];
    const Vec3 area = (mesh.vertices[triangle[1]] - first).cross(mesh.vertices[triangle[2]] - first);
    MeshSurface::Face face{triangle, {}, area.normalized(), {}, {}};
    for (std::size_t i = 0; i < 3; ++i) face.ownsVertex[i] = !std::exchange(isOwned[triangle[i]], 1);
    surface.faces.push_back(face);
  }
}

/// The edge of two sides.
MeshSurface::Edge edgeOf(const Side& one, const Side& other, const MeshSurface& surface) {
  const MeshSurface::Face &face = surface.faces[one.face], &next = surface.faces[other.face];
  MeshSurface::Edge edge{
      {one.low, one.high}, {face.vertices[(one.corner + 2) % 3], next.vertices[(other.corner + 2) % 3]}, {}, false};
  edge.normal = (face.normal + next.normal).normalized();
  const Vec3 acrossNext = surface.vertices[edge.across[1]] - surface.vertices[edge.vertices[0]];
  const Vec3 across = surface.vertices[edge.across[0]] - surface.vertices[edge.vertices[0]];
  edge.isConvex = face.normal.dot(acrossNext) < -kFlatPart * acrossNext.norm() ||
                  next.normal.dot(across) < -kFlatPart * across.norm();
  return edge;
}

void addEdges(MeshSurface& surface) {
  const std::vector<Side> sides = sortedSides(surface);
  CRADLE_CHECK(sides.size() % 2 == 0);
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    const Side &one = sides[i], &other = sides[i + 1];
    CRADLE_CHECK(one.low == other.low && one.high == other.high);
    surface.faces[one.face].ownsEdge[one.corner] = true;
    for (const Side& side : {one, other})
      surface.faces[side.face].edges[side.corner] = static_cast<std::uint32_t>(surface.edges.size());
    surface.edges.push_back(edgeOf(one, other, surface));
  }
}

void addVertexNormals(MeshSurface& surface) {
  surface.vertexNormals.assign(surface.vertices.size(), Vec3::Zero());
  for (const MeshSurface::Face& face : surface.faces)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& corner = surface.vertices[face.vertices[i]];
      const Vec3 next = (surface.vertices[face.vertices[(i + 1) % 3]] - corner).normalized();
      const Vec3 last = (surface.vertices[face.vertices[(i + 2) % 3]] - corner).normalized();
      surface.vertexNormals[face.vertices[i]] += angleBetween(next, last) * face.normal;
    }
  for (Vec3& normal : surface.vertexNormals) normal.normalize();
}

void addNeighbours(MeshSurface& surface) {
  surface.firstNeighbour.assign(surface.vertices.size() + 1, 0);
  for (const MeshSurface::Edge& edge : surface.edges)
    for (const std::uint32_t vertex : edge.vertices) ++surface.firstNeighbour[vertex + 1];
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) surface.firstNeighbour[i + 1] += surface.firstNeighbour[i];
  std::vector<std::uint32_t> next = surface.firstNeighbour;
  surface.neighbours.resize(2 * surface.edges.size());
  for (const auto& [ends, across, normal, isConvex] : surface.edges) {
    surface.neighbours[next[ends[0]]++] = ends[1];
    surface.neighbours[next[ends[1]]++] = ends[0];
  }
}

void addParts(MeshSurface& surface) {
  std::vector<char> isReached(surface.vertices.size(), 0);
  for (const MeshSurface::Face& face : surface.faces) {
    if (isReached[face.vertices[0]]) continue;
    surface.parts.push_back(face.vertices[0]);
    std::vector<std::uint32_t> open{face.vertices[0]};
    isReached[face.vertices[0]] = 1;
    while (!open.empty()) {
      const std::uint32_t vertex = open.back();
      open.pop_back();
      for (std::uint32_t i = surface.firstNeighbour[vertex]; i < surface.firstNeighbour[vertex + 1]; ++i)
        if (!std::exchange(isReached[surface.neighbours[i]], 1)) open.push_back(surface.neighbours[i]);
    }
  }
}

}  // namespace

MeshSurface surfaceOf(const TriangleMesh& mesh) {
  MeshSurface surface;
  surface.vertices = mesh.vertices;
  addFaces(mesh, surface);
  addEdges(surface);
  addVertexNormals(surface);
  addNeighbours(surface);
  addParts(surface);
  surface.tree = buildTree(mesh);
  surface.size = 2 * surface.tree.nodes[0].halfSize.norm();
  return surface;
}

}  // namespace cradle
