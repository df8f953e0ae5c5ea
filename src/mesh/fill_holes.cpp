#include "mesh/fill_holes.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

namespace cradle {
namespace {

constexpr double kMaxHoleRatio = 0.05;     // of the mesh's diagonal
constexpr double kMaxHeightRatio = 0.2;    // of the hole's: so far its corners may be off its plane
constexpr double kMinAreaRatio = 1e-9;     // of the square of the hole's diagonal: a crack has no way to be filled
constexpr std::size_t kMaxCorners = 1000;  // of a hole

using Ring = std::vector<std::uint32_t>;  // vertices, counter-clockwise seen from outside

/// The next vertex of a hole by the one before; none if the surface has other faults than holes that do not touch.
std::optional<std::map<std::uint32_t, std::uint32_t>> holeEdges(const TriangleMesh& mesh) {
  const auto keyOf = [](std::uint64_t from, std::uint64_t to) { return from << 32 | to; };
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Triangle& triangle : mesh.triangles)
    for (std::size_t corner = 0; corner < 3; ++corner)
      edges.push_back(keyOf(triangle[corner], triangle[(corner + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return std::nullopt;
  std::map<std::uint32_t, std::uint32_t> next;
  for (const std::uint64_t edge : edges) {
    const auto from = static_cast<std::uint32_t>(edge >> 32), to = static_cast<std::uint32_t>(edge);
    if (std::binary_search(edges.begin(), edges.end(), keyOf(to, from))) continue;
    if (!next.emplace(to, from).second) return std::nullopt;
  }
  return next;
}

std::vector<Ring> ringsOf(std::map<std::uint32_t, std::uint32_t> next) {
  std::vector<Ring> rings;
  while (!next.empty()) {
    Ring& ring = rings.emplace_back();
    for (auto edge = next.begin(); edge != next.end(); edge = next.find(ring.back())) {
      ring.push_back(edge->second);
      next.erase(edge);
    }
  }
  return rings;
}

double sizeOf(const Ring& ring, const TriangleMesh& mesh) {
  Bounds bounds;
  for (const std::uint32_t vertex : ring) bounds.extend(mesh.vertices[vertex]);
  return bounds.diagonal().norm();
}

double crossOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a, v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

/// The corners of a ring in its plane (m); none if it is not nearly flat.
std::optional<std::vector<Eigen::Vector2d>> flattened(const Ring& ring, const TriangleMesh& mesh) {
  const Vec3& first = mesh.vertices[ring[0]];
  const double size = sizeOf(ring, mesh);
  Vec3 normal = Vec3::Zero(), middle = Vec3::Zero();  // twice the area; m
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec3 a = mesh.vertices[ring[i]] - first, b = mesh.vertices[ring[(i + 1) % ring.size()]] - first;
    normal += a.cross(b);
    middle += a / static_cast<double>(ring.size());
  }
  if (!(normal.norm() > kMinAreaRatio * size * size)) return std::nullopt;
  normal.normalize();
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  std::vector<Eigen::Vector2d> points;
  for (const std::uint32_t vertex : ring) {
    const Vec3 from = mesh.vertices[vertex] - first - middle;
    if (std::abs(from.dot(normal)) > kMaxHeightRatio * size) return std::nullopt;
    points.emplace_back(from.dot(u), from.dot(v));
  }
  return points;
}

/// Whether corner `i` of a polygon is an ear: convex, and no other corner in its triangle.
bool isEar(const std::vector<Eigen::Vector2d>& points, std::size_t i) {
  const std::size_t count = points.size(), before = (i + count - 1) % count, after = (i + 1) % count;
  const Eigen::Vector2d &a = points[before], &b = points[i], &c = points[after];
  if (!(crossOf(a, b, c) > 0)) return false;
  for (std::size_t k = 0; k < count; ++k) {
    if (k == before || k == i || k == after) continue;
    const Eigen::Vector2d& point = points[k];
    if (crossOf(a, b, point) >= 0 && crossOf(b, c, point) >= 0 && crossOf(c, a, point) >= 0) return false;
  }
  return true;
}

/// Triangles that fill a ring, by cutting off ears; none if it crosses itself.
std::optional<std::vector<Triangle>> filling(Ring ring, std::vector<Eigen::Vector2d> points) {
  std::vector<Triangle> triangles;
  while (ring.size() >= 3) {
    const std::size_t count = ring.size();
    std::size_t ear = 0;
    while (ear < count && !isEar(points, ear)) ++ear;
    if (ear == count) return std::nullopt;
    triangles.push_back({ring[(ear + count - 1) % count], ring[ear], ring[(ear + 1) % count]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    points.erase(points.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

void addTriangle(const Triangle& triangle, Model& model) {
  model.solid.triangles.push_back(triangle);
  DrawnMesh& drawn = model.drawn;
  if (drawn.triangles.empty()) return;
  const auto first = static_cast<std::uint32_t>(drawn.vertices.size());
  const auto place = [&](std::size_t corner) { return model.solid.vertices[triangle[corner]]; };
  const Vec3 normal = (place(1) - place(0)).cross(place(2) - place(0)).normalized();
  for (std::size_t corner = 0; corner < 3; ++corner) {
    drawn.vertices.push_back(place(corner));
    drawn.normals.push_back(normal.cast<float>());
  }
  if (!drawn.textureCoordinates.empty()) drawn.textureCoordinates.resize(drawn.vertices.size(), Vec2f::Zero());
  drawn.triangles.push_back({first, first + 1, first + 2});
  if (!drawn.materials.empty()) ++drawn.materials.back().triangleCount;
}

}  // namespace

void fillHoles(LoadedModel& loaded) {
  const TriangleMesh& solid = loaded.model.solid;
  auto edges = holeEdges(solid);
  if (!edges || edges->empty()) return;
  Bounds bounds;
  for (const Vec3& vertex : solid.vertices) bounds.extend(vertex);
  std::vector<Triangle> all;
  double largest = 0;  // m
  const std::vector<Ring> rings = ringsOf(std::move(*edges));
  for (const Ring& ring : rings) {
    const double size = sizeOf(ring, solid);
    if (ring.size() < 3 || ring.size() > kMaxCorners || !(size < kMaxHoleRatio * bounds.diagonal().norm())) return;
    const auto points = flattened(ring, solid);
    const auto triangles = points ? filling(ring, *points) : std::nullopt;
    if (!triangles) return;
    all.insert(all.end(), triangles->begin(), triangles->end());
    largest = std::max(largest, size);
  }
  for (const Triangle& triangle : all) addTriangle(triangle, loaded.model);
  loaded.notes.push_back(fmt::format("{} hole{} filled, the largest {:.3g} m across", rings.size(),
                                     rings.size() == 1 ? "" : "s", largest));
}

}  // namespace cradle
