#include "collision/polytope_contact.h"

#include <algorithm>
#include <limits>

namespace cradle {
namespace {

constexpr double kParallelSine = 1e-6;    // edges at a smaller angle give no axis: face normals cover them
constexpr double kFacePreference = 1e-7;  // of the size: a face is taken unless an edge pair is clearly farther apart
constexpr double kFlat = std::numeric_limits<double>::infinity();   // m: radius of a plane
constexpr double kEdge = std::numeric_limits<double>::quiet_NaN();  // an edge has none

/// An axis that may separate A (behind) from B (ahead).
struct Axis {
  double separation = -std::numeric_limits<double>::infinity();  // m
  Vec3 normal = Vec3::UnitY();                                   // unit, from A to B, A's frame
  enum class Kind { faceOfA, faceOfB, edges } kind = Kind::faceOfA;
  std::size_t featureA = 0, featureB = 0;  // face, or edge direction
};

double leastAlong(const std::vector<Vec3>& points, const Vec3& direction) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) least = std::min(least, direction.dot(point));
  return least;
}

/// B as seen from A's frame.
struct Posed {
  const Polytope& shape;
  const RigidTransform& aFromShape;
  std::vector<Vec3> vertices;

  Posed(const Polytope& polytope, const RigidTransform& transform) : shape(polytope), aFromShape(transform) {
    for (const Vec3& vertex : polytope.vertices) vertices.push_back(transform * vertex);
  }
  Vec3 turned(const Vec3& direction) const { return aFromShape.rotation * direction; }
};

Axis bestFace(const Polytope& a, const Posed& b) {
  Axis best;
  for (std::size_t i = 0; i < a.faces.size(); ++i) {
    const double separation = leastAlong(b.vertices, a.faces[i].normal) - a.faces[i].offset;
    if (separation > best.separation) best = {separation, a.faces[i].normal, Axis::Kind::faceOfA, i, 0};
  }
  for (std::size_t i = 0; i < b.shape.faces.size(); ++i) {
    const Vec3 normal = b.turned(b.shape.faces[i].normal);
    const double offset = b.shape.faces[i].offset + normal.dot(b.aFromShape.translation);
    const double separation = leastAlong(a.vertices, normal) - offset;
    if (separation > best.separation) best = {separation, -normal, Axis::Kind::faceOfB, 0, i};
  }
  return best;
}

Axis bestEdges(const Polytope& a, const Posed& b) {
  Axis best;
  for (std::size_t i = 0; i < a.edgeDirections.size(); ++i)
    for (std::size_t j = 0; j < b.shape.edgeDirections.size(); ++j) {
      Vec3 normal = a.edgeDirections[i].cross(b.turned(b.shape.edgeDirections[j]));
      const double sine = normal.norm();
      if (sine < kParallelSine) continue;
      normal /= sine;
      for (const double sign : {1.0, -1.0}) {
        const Vec3 towardsB = sign * normal;
        const double separation = leastAlong(b.vertices, towardsB) + leastAlong(a.vertices, -towardsB);
        if (separation > best.separation) best = {separation, towardsB, Axis::Kind::edges, i, j};
      }
    }
  return best;
}

double sizeOf(const Polytope& polytope) {
  double size = 0;
  for (const Vec3& vertex : polytope.vertices) size = std::max(size, vertex.norm());
  return size;
}

/// The part of a polygon on the inner side of a plane.
std::vector<Vec3> clip(const std::vector<Vec3>& polygon, const Vec3& outward, double offset) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double heightFrom = outward.dot(from) - offset, heightTo = outward.dot(to) - offset;
    if (heightFrom <= 0) kept.push_back(from);
    if ((heightFrom < 0) != (heightTo < 0) && heightFrom != heightTo && heightFrom != 0 && heightTo != 0)
      kept.push_back(from + heightFrom / (heightFrom - heightTo) * (to - from));
  }
  return kept;
}

/// Contacts of `incident` on a face of `reference`, in the reference's frame. Normals point out of the reference, which
/// is A. Points of the incident face count as corners, also where it was clipped: they lie on it.
std::vector<ContactPoint> clipAgainstFace(const Polytope& reference, std::size_t faceIndex, const Posed& incident,
                                          double margin) {
  const Polytope::Face& face = reference.faces[faceIndex];
  const auto facing = std::min_element(
      incident.shape.faces.begin(), incident.shape.faces.end(), [&](const auto& left, const auto& right) {
        return incident.turned(left.normal).dot(face.normal) < incident.turned(right.normal).dot(face.normal);
      });
  std::vector<Vec3> polygon;
  for (const std::size_t vertex : facing->loop) polygon.push_back(incident.vertices[vertex]);
  for (std::size_t i = 0; i < face.loop.size() && !polygon.empty(); ++i) {
    const Vec3& from = reference.vertices[face.loop[i]];
    const Vec3 outward =
        (reference.vertices[face.loop[(i + 1) % face.loop.size()]] - from).cross(face.normal).normalized();
    polygon = clip(polygon, outward, outward.dot(from));
  }
  std::vector<ContactPoint> points;
  for (const Vec3& corner : polygon) {
    const double separation = face.normal.dot(corner) - face.offset;
    if (separation <= margin)
      points.push_back({corner - separation / 2 * face.normal, face.normal, separation, kFlat, 0});
  }
  return points;
}

/// The edge along a direction that lies farthest along `normal`.
Polytope::Edge farthestEdge(const Polytope& shape, const std::vector<Vec3>& vertices, const Vec3& direction,
                            const Vec3& normal) {
  Polytope::Edge best = shape.edges[0];
  double farthest = -std::numeric_limits<double>::infinity();
  for (const Polytope::Edge& edge : shape.edges) {
    const Vec3 along = vertices[edge.to] - vertices[edge.from];
    if (along.cross(direction).norm() > kParallelSine * along.norm()) continue;
    const double height = normal.dot(vertices[edge.from] + vertices[edge.to]);
    if (height > farthest) farthest = height, best = edge;
  }
  return best;
}

ContactPoint nearestOfEdges(const Polytope& a, const Posed& b, const Axis& axis) {
  const Vec3 directionA = a.edgeDirections[axis.featureA];
  const Vec3 directionB = b.turned(b.shape.edgeDirections[axis.featureB]);
  const Polytope::Edge edgeA = farthestEdge(a, a.vertices, directionA, axis.normal);
  const Polytope::Edge edgeB = farthestEdge(b.shape, b.vertices, directionB, -axis.normal);
  const Vec3 &pointA = a.vertices[edgeA.from], &pointB = b.vertices[edgeB.from], between = pointB - pointA;
  const double cosine = directionA.dot(directionB);
  const double alongA = (between.dot(directionA) - cosine * between.dot(directionB)) / (1 - cosine * cosine);
  const Vec3 middle = pointA + alongA * directionA + axis.separation / 2 * axis.normal;
  return {middle, axis.normal, axis.separation, kEdge, kEdge};
}

}  // namespace

double separationOf(const Polytope& a, const Polytope& b, const RigidTransform& worldFromA,
                    const RigidTransform& worldFromB) {
  const RigidTransform aFromB = worldFromA.inverse() * worldFromB;
  const Posed posed(b, aFromB);
  return std::max(bestFace(a, posed).separation, bestEdges(a, posed).separation);
}

void appendContacts(const Polytope& a, const Polytope& b, const RigidTransform& worldFromA,
                    const RigidTransform& worldFromB, double margin, std::vector<ContactPoint>& points) {
  const RigidTransform aFromB = worldFromA.inverse() * worldFromB, bFromA = aFromB.inverse();
  const Posed posed(b, aFromB);
  const Axis face = bestFace(a, posed), edges = bestEdges(a, posed);
  const bool byEdges = edges.separation > face.separation + kFacePreference * std::min(sizeOf(a), sizeOf(b));
  if ((byEdges ? edges : face).separation > margin) return;

  const auto append = [&](ContactPoint found, const RigidTransform& worldFromFrame, double sign) {
    if (sign < 0) std::swap(found.radiusA, found.radiusB);
    found.point = worldFromFrame * found.point;
    found.normal = sign * (worldFromFrame.rotation * found.normal);
    points.push_back(found);
  };
  if (byEdges) {
    append(nearestOfEdges(a, posed, edges), worldFromA, 1);
  } else if (face.kind == Axis::Kind::faceOfA) {
    for (const ContactPoint& found : clipAgainstFace(a, face.featureA, posed, margin)) append(found, worldFromA, 1);
  } else {
    for (const ContactPoint& found : clipAgainstFace(b, face.featureB, Posed(a, bFromA), margin))
      append(found, worldFromB, -1);
  }
}

}  // namespace cradle
