#include "collision/polytope.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "collision/contact_point.h"
#include "math/elementary.h"

namespace cradle {
namespace {

// Vertices of a polytope up to which a look at all of them is faster than a walk along edges, which jumps in memory.
constexpr std::size_t kMaxScannedVertices = 20;

struct FacePoint {
  Vec3 point;     // m
  double radius;  // m, as in SurfacePoint
};

/// Nearest point of a convex polygon in the plane of its face.
FacePoint nearestOnFace(const Polytope& polytope, const Polytope::Face& face, const Vec3& point) {
  const Vec3 inPlane = point - (face.normal.dot(point) - face.offset) * face.normal;
  FacePoint nearest{inPlane, kFlat};
  double least = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (std::size_t i = 0; i < face.loop.size(); ++i) {
    const Vec3& from = polytope.vertices[face.loop[i]];
    const Vec3 along = polytope.vertices[face.loop[(i + 1) % face.loop.size()]] - from;
    if (face.normal.cross(along).dot(inPlane - from) >= 0) continue;
    inside = false;
    const double part = std::clamp(along.dot(inPlane - from) / along.squaredNorm(), 0.0, 1.0);
    const Vec3 candidate = from + part * along;
    if ((candidate - point).squaredNorm() < least) {
      least = (candidate - point).squaredNorm();
      nearest = {candidate, part > 0 && part < 1 ? kNotRound : 0};
    }
  }
  return inside ? FacePoint{inPlane, kFlat} : nearest;
}

/// Twice the area (m^2) of a loop of vertices, along its normal.
Vec3 areaVector(const std::vector<Vec3>& vertices, const std::vector<std::size_t>& loop) {
  Vec3 area = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < loop.size(); ++i)
    area += (vertices[loop[i]] - vertices[loop[0]]).cross(vertices[loop[i + 1]] - vertices[loop[0]]);
  return area;
}

/// Edges from the faces' loops, in their order, then the neighbours of each vertex.
void addEdges(Polytope& polytope) {
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> known;  // edge from its ends
  for (std::size_t face = 0; face < polytope.faces.size(); ++face) {
    const std::vector<std::size_t>& loop = polytope.faces[face].loop;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::size_t from = loop[i], to = loop[(i + 1) % loop.size()];
      if (const auto opposite = known.find({to, from}); opposite != known.end()) {
        polytope.edges[opposite->second].right = face;
      } else {
        known[{from, to}] = polytope.edges.size();
        polytope.edges.push_back({from, to, face, face});
      }
    }
  }
  for (std::size_t vertex = 0; vertex < polytope.vertices.size(); ++vertex) {
    polytope.firstNeighbor.push_back(polytope.neighbors.size());
    for (std::size_t edge = 0; edge < polytope.edges.size(); ++edge) {
      const auto& [from, to, left, right] = polytope.edges[edge];
      if (from != vertex && to != vertex) continue;
      polytope.neighbors.push_back(from == vertex ? to : from);
      polytope.edgesAt.push_back(edge);
    }
  }
  polytope.firstNeighbor.push_back(polytope.neighbors.size());
}

}  // namespace

Polytope polytopeOf(const ConvexHull& hull) {
  Polytope polytope;
  polytope.vertices = hull.vertices;
  for (const std::vector<std::size_t>& loop : hull.faces) {
    const Vec3 normal = areaVector(hull.vertices, loop).normalized();
    double offset = -std::numeric_limits<double>::infinity();
    for (const Vec3& vertex : hull.vertices) offset = std::max(offset, normal.dot(vertex));
    polytope.faces.push_back({normal, offset, loop});
  }
  addEdges(polytope);
  return polytope;
}

Polytope polytopeOf(const Box& box, const RigidTransform& frameFromBox) {
  Polytope polytope;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const Vec3 signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    polytope.vertices.push_back(frameFromBox * (signs.cwiseProduct(box.size) / 2));
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t bit = std::size_t{1} << axis, next = std::size_t{1} << (axis + 1) % 3,
                      last = std::size_t{1} << (axis + 2) % 3;
    const Vec3 direction = frameFromBox.rotation * Vec3::Unit(static_cast<Eigen::Index>(axis));
    for (const std::size_t side : {bit, std::size_t{0}}) {
      std::vector<std::size_t> loop{side, side | next, side | next | last, side | last};
      if (side == 0) std::swap(loop[1], loop[3]);
      const Vec3 normal = side ? direction : Vec3(-direction);
      polytope.faces.push_back({normal, normal.dot(polytope.vertices[loop[0]]), loop});
    }
  }
  addEdges(polytope);
  return polytope;
}

Polytope inscribedPrism(const Cylinder& cylinder, const RigidTransform& frameFromCylinder) {
  // The prism's faces are within 2 % of the radius below the cylinder: 1 - cos(pi / 16).
  constexpr std::size_t kSides = 16;
  ConvexHull hull;
  std::vector<std::size_t> top, bottom;
  for (std::size_t side = 0; side < kSides; ++side) {
    const auto [x, z] = sinCos(2 * std::numbers::pi * static_cast<double>(side) / kSides);
    const Vec3 radial = cylinder.radius * Vec3(x, 0, z), up = cylinder.length / 2 * Vec3::UnitY();
    hull.vertices.push_back(frameFromCylinder * (radial + up));
    hull.vertices.push_back(frameFromCylinder * (radial - up));
    top.push_back(2 * side);
    bottom.insert(bottom.begin(), 2 * side + 1);
    const std::size_t next = (side + 1) % kSides;
    hull.faces.push_back({2 * side, 2 * side + 1, 2 * next + 1, 2 * next});
  }
  hull.faces.push_back(top);
  hull.faces.push_back(bottom);
  return polytopeOf(hull);
}

Polytope segmentBetween(const Vec3& from, const Vec3& to) {
  Polytope segment;
  segment.vertices = {from, to};
  segment.firstNeighbor = {0, 1, 2};
  segment.neighbors = {1, 0};
  return segment;
}

std::size_t supportVertex(const Polytope& polytope, const Vec3& direction, std::size_t start) {
  const std::size_t count = polytope.vertices.size();
  std::size_t best = count <= kMaxScannedVertices ? 0 : start;
  double farthest = direction.dot(polytope.vertices[best]);
  const auto look = [&](std::size_t vertex) {
    const double reach = direction.dot(polytope.vertices[vertex]);
    if (reach > farthest) farthest = reach, best = vertex;
  };
  if (count <= kMaxScannedVertices) {
    for (std::size_t vertex = 1; vertex < count; ++vertex) look(vertex);
    return best;
  }
  for (std::size_t from = count; from != best;) {  // uphill along the edges: a convex shape has one maximum
    from = best;
    for (std::size_t i = polytope.firstNeighbor[from]; i < polytope.firstNeighbor[from + 1]; ++i)
      look(polytope.neighbors[i]);
  }
  return best;
}

SurfacePoint nearestSurfacePoint(const Polytope& polytope, const Vec3& point) {
  // Inside, the nearest face's plane is nearest; outside, the nearest of the faces that see the point.
  const Polytope::Face* highest = polytope.faces.data();
  double most = -std::numeric_limits<double>::infinity();
  for (const Polytope::Face& face : polytope.faces) {
    const double height = face.normal.dot(point) - face.offset;
    if (height > most) most = height, highest = &face;
  }
  SurfacePoint result{most, point - most * highest->normal, highest->normal, kFlat};
  if (most <= 0) return result;
  double least = std::numeric_limits<double>::infinity();
  for (const Polytope::Face& face : polytope.faces) {
    const double height = face.normal.dot(point) - face.offset;
    if (height <= 0) continue;
    const auto [nearest, radius] = nearestOnFace(polytope, face, point);
    const double distance = radius == kFlat ? height : (point - nearest).norm();
    if (distance >= least) continue;
    least = distance;
    const bool isBeside = radius != kFlat && distance > 0;
    result = {distance, nearest, isBeside ? Vec3((point - nearest) / distance) : face.normal, radius};
  }
  return result;
}

}  // namespace cradle
