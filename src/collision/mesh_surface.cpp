// J. A. Baerentzen, H. Aanaes, "Signed distance computation using the angle weighted pseudonormal", IEEE Trans.
// Visualization and Computer Graphics 11(3), 2005: with the mean normal of an edge's triangles, and the mean weighted
// by angle of a vertex's, the sign of (point - nearest point) . normal says exactly whether a point is inside.
//
// Both sides of a sheet make a closed surface: where two triangles meet, each side goes on from one to the other; at a
// border, and where more than two meet, a triangle's front goes over into its own back. A vertex inside the sheet is
// one of the front and another of the back; at a border they are one.

#include "collision/mesh_surface.h"

#include <algorithm>
#include <utility>

#include "core/error.h"

namespace cradle {
namespace {

// Of a triangle's length: two triangles that bend by less lie in one plane. The vertices of flat faces are rounded to a
// unit roundoff of the mesh, whose triangles may be a millionth of it.
constexpr double kFlatRatio = 1e-9;
// Of a triangle's length: 90 unit roundoffs; what bends by less is straight to rounding.
constexpr double kStraightRatio = 1e-14;
// Of the weighted mean of a vertex's normals (rad): both sides of a sheet cancel in a shorter one, which has no
// direction.
constexpr double kMinMeanNormal = 1e-6;

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

/// Two sides of triangles that meet at an edge.
using Seam = std::pair<Side, Side>;

/// The seams of a closed mesh: sides that are next to each other in order of their vertices.
std::vector<Seam> seamsOf(const MeshSurface& surface) {
  const std::vector<Side> sides = sortedSides(surface);
  CRADLE_CHECK(sides.size() % 2 == 0);
  std::vector<Seam> seams;
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    CRADLE_CHECK(sides[i].low == sides[i + 1].low && sides[i].high == sides[i + 1].high);
    seams.emplace_back(sides[i], sides[i + 1]);
  }
  return seams;
}

/// The edge of two sides. Where a sheet's front goes over into its back, the edge's normal is along the sheet.
MeshSurface::Edge edgeOf(const Seam& seam, const MeshSurface& surface) {
  const auto& [one, other] = seam;
  const MeshSurface::Face &face = surface.faces[one.face], &next = surface.faces[other.face];
  MeshSurface::Edge edge{{one.low, one.high},
                         {face.vertices[(one.corner + 2) % 3], next.vertices[(other.corner + 2) % 3]},
                         {},
                         false,
                         {one.face, other.face}};
  const Vec3 &from = surface.vertices[edge.vertices[0]], &to = surface.vertices[edge.vertices[1]];
  const Vec3 acrossNext = surface.vertices[edge.across[1]] - from, across = surface.vertices[edge.across[0]] - from;
  const bool isFold =
      surface.isSheet && one.face % (surface.faces.size() / 2) == other.face % (surface.faces.size() / 2);
  if (isFold) {
    const Vec3 along = (to - from).normalized();
    edge.normal = (along * along.dot(across) - across).normalized();
    edge.isConvex = edge.isBorder = true;
    return edge;
  }
  edge.normal = (face.normal + next.normal).normalized();
  edge.isConvex = face.normal.dot(acrossNext) < -kFlatRatio * acrossNext.norm() ||
                  next.normal.dot(across) < -kFlatRatio * across.norm();
  edge.isBent = !(face.normal.dot(next.normal) > 0) ||
                std::abs(face.normal.dot(acrossNext)) > kStraightRatio * acrossNext.norm() ||
                std::abs(next.normal.dot(across)) > kStraightRatio * across.norm();
  return edge;
}

void addEdges(const std::vector<Seam>& seams, MeshSurface& surface) {
  for (const Seam& seam : seams) {
    const auto& [one, other] = seam;
    surface.faces[one.face].ownsEdge[one.corner] = true;
    for (const Side& side : {one, other})
      surface.faces[side.face].edges[side.corner] = static_cast<std::uint32_t>(surface.edges.size());
    surface.edges.push_back(edgeOf(seam, surface));
  }
}

/// Whether the surface goes straight on over an edge.
bool isFlat(const MeshSurface& surface, const MeshSurface::Edge& edge) {
  const Vec3 &normal = surface.faces[edge.faces[0]].normal, &next = surface.faces[edge.faces[1]].normal;
  if (edge.isConvex || normal.dot(next) <= 0) return false;
  const Vec3 side = surface.vertices[edge.across[1]] - surface.vertices[edge.vertices[0]];
  return std::abs(normal.dot(side)) <= kFlatRatio * side.norm();
}

void addRegions(MeshSurface& surface) {
  constexpr std::uint32_t kNoRegion = ~std::uint32_t{0};
  surface.regions.assign(surface.faces.size(), kNoRegion);
  std::uint32_t count = 0;
  for (std::uint32_t first = 0; first < surface.faces.size(); ++first) {
    if (surface.regions[first] != kNoRegion) continue;
    surface.firstBorder.push_back(static_cast<std::uint32_t>(surface.borders.size()));
    std::vector<std::uint32_t> open{first};
    surface.regions[first] = count;
    while (!open.empty()) {
      const std::uint32_t at = open.back();
      open.pop_back();
      for (const std::uint32_t index : surface.faces[at].edges) {
        const MeshSurface::Edge& edge = surface.edges[index];
        const std::uint32_t next = edge.faces[edge.faces[0] == at ? 1 : 0];
        if (!isFlat(surface, edge))
          surface.borders.push_back(index);
        else if (surface.regions[next] == kNoRegion)
          surface.regions[next] = count, open.push_back(next);
      }
    }
    ++count;
  }
  surface.firstBorder.push_back(static_cast<std::uint32_t>(surface.borders.size()));
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
  for (Vec3& normal : surface.vertexNormals)
    normal = normal.norm() > (surface.isSheet ? kMinMeanNormal : 0) ? Vec3(normal.normalized()) : Vec3(Vec3::Zero());
}

void addNeighbours(MeshSurface& surface) {
  surface.firstNeighbour.assign(surface.vertices.size() + 1, 0);
  for (const MeshSurface::Edge& edge : surface.edges)
    for (const std::uint32_t vertex : edge.vertices) ++surface.firstNeighbour[vertex + 1];
  for (std::size_t i = 0; i < surface.vertices.size(); ++i) surface.firstNeighbour[i + 1] += surface.firstNeighbour[i];
  std::vector<std::uint32_t> next = surface.firstNeighbour;
  surface.neighbours.resize(2 * surface.edges.size());
  for (const MeshSurface::Edge& edge : surface.edges) {
    const auto& ends = edge.vertices;
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

/// Adds the inner point of a convex solid: the mean of its vertices.
void addInnerPoint(MeshSurface& surface) {
  const auto isHollow = [&](const MeshSurface::Edge& edge) { return !edge.isConvex && !isFlat(surface, edge); };
  if (surface.isSheet || surface.parts.size() != 1) return;
  if (std::any_of(surface.edges.begin(), surface.edges.end(), isHollow)) return;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& vertex : surface.vertices) sum += vertex;
  surface.inner = sum / static_cast<double>(surface.vertices.size());
}

void complete(const TriangleMesh& mesh, const std::vector<Seam>& seams, MeshSurface& surface) {
  addEdges(seams, surface);
  addRegions(surface);
  addVertexNormals(surface);
  addNeighbours(surface);
  addParts(surface);
  surface.tree = buildBvh(mesh);
  surface.size = 2 * surface.tree.nodes[0].halfSize.norm();
  for (const MeshSurface::Edge& edge : surface.edges) {
    const auto& [from, to] = edge.vertices;
    surface.edgeLength +=
        (surface.vertices[to] - surface.vertices[from]).norm() / static_cast<double>(surface.edges.size());
  }
  addInnerPoint(surface);
}

/// Corners of triangles that are one vertex, by number 3 * triangle + corner.
class Corners {
 public:
  explicit Corners(std::size_t count) : next_(count) {
    for (std::uint32_t i = 0; i < count; ++i) next_[i] = i;
  }

  std::uint32_t first(std::uint32_t corner) {
    while (next_[corner] != corner) corner = next_[corner] = next_[next_[corner]];
    return corner;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = first(a), b = first(b);
    next_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> next_;
};

/// The back of a front side, and the other way round. Its triangle's corners are 0, 2, 1.
Side turnedOver(const Side& side, std::uint32_t triangles) {
  return {side.low, side.high, side.face < triangles ? side.face + triangles : side.face - triangles, 2 - side.corner};
}

/// Seams of a sheet's two sides, whose fronts are the first half of the faces.
std::vector<Seam> seamsOfSides(const MeshSurface& surface) {
  const auto triangles = static_cast<std::uint32_t>(surface.faces.size() / 2);
  std::vector<Side> fronts = sortedSides(surface);
  std::erase_if(fronts, [&](const Side& side) { return side.face >= triangles; });
  std::vector<Seam> seams;
  for (std::size_t i = 0, end = 0; i < fronts.size(); i = end) {
    while (end < fronts.size() && fronts[end].low == fronts[i].low && fronts[end].high == fronts[i].high) ++end;
    if (end - i == 2) {
      const auto startOf = [&](const Side& side) { return surface.faces[side.face].vertices[side.corner]; };
      const Side &one = fronts[i], &other = fronts[i + 1];
      const bool isWoundAlike = startOf(one) != startOf(other);
      seams.emplace_back(one, isWoundAlike ? other : turnedOver(other, triangles));
      seams.emplace_back(turnedOver(one, triangles), isWoundAlike ? turnedOver(other, triangles) : other);
      continue;
    }
    for (std::size_t k = i; k < end; ++k) seams.emplace_back(fronts[k], turnedOver(fronts[k], triangles));
  }
  return seams;
}

/// Gives vertices that only lie in one place numbers of their own.
void separateVertices(std::vector<Seam>& seams, TriangleMesh& mesh) {
  Corners corners(3 * mesh.triangles.size());
  const auto cornerAt = [&](const Side& side, std::uint32_t vertex) {
    const bool isFirst = mesh.triangles[side.face][side.corner] == vertex;
    return 3 * side.face + (isFirst ? side.corner : (side.corner + 1) % 3);
  };
  for (const auto& [one, other] : seams)
    for (const std::uint32_t vertex : {one.low, one.high}) corners.join(cornerAt(one, vertex), cornerAt(other, vertex));
  std::vector<std::uint32_t> numbers(3 * mesh.triangles.size());
  std::vector<Vec3> vertices;
  for (std::uint32_t corner = 0; corner < numbers.size(); ++corner) {
    const std::uint32_t first = corners.first(corner);
    if (first == corner) {
      numbers[corner] = static_cast<std::uint32_t>(vertices.size());
      vertices.push_back(mesh.vertices[mesh.triangles[corner / 3][corner % 3]]);
    }
    numbers[corner] = numbers[first];
  }
  for (auto& [one, other] : seams) {
    const std::array<std::uint32_t, 2> ends{numbers[cornerAt(one, one.low)], numbers[cornerAt(one, one.high)]};
    for (Side* side : {&one, &other}) side->low = ends[0], side->high = ends[1];
  }
  for (std::uint32_t corner = 0; corner < numbers.size(); ++corner)
    mesh.triangles[corner / 3][corner % 3] = numbers[corner];
  mesh.vertices = std::move(vertices);
}

}  // namespace

MeshSurface surfaceOf(const TriangleMesh& mesh) {
  MeshSurface surface;
  surface.vertices = mesh.vertices;
  addFaces(mesh, surface);
  complete(mesh, seamsOf(surface), surface);
  return surface;
}

MeshSurface sheetOf(const TriangleMesh& mesh) {
  TriangleMesh sides = mesh;
  for (const auto& [first, second, third] : mesh.triangles) sides.triangles.push_back({first, third, second});
  MeshSurface surface;
  surface.isSheet = true;
  surface.vertices = sides.vertices;
  addFaces(sides, surface);
  std::vector<Seam> seams = seamsOfSides(surface);
  separateVertices(seams, sides);
  surface.vertices = sides.vertices;
  surface.faces.clear();
  addFaces(sides, surface);
  complete(sides, seams, surface);
  return surface;
}

}  // namespace cradle
