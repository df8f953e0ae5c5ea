#include "collision/polytope.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cradle {
namespace {

constexpr double kFlat = std::numeric_limits<double>::infinity();
constexpr double kEdge = std::numeric_limits<double>::quiet_NaN();

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
      nearest = {candidate, part > 0 && part < 1 ? kEdge : 0};
    }
  }
  return inside ? FacePoint{inPlane, kFlat} : nearest;
}

}  // namespace

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
    polytope.edgeDirections.push_back(direction);
    for (const std::size_t side : {bit, std::size_t{0}}) {
      std::vector<std::size_t> loop{side, side | next, side | next | last, side | last};
      if (side == 0) std::swap(loop[1], loop[3]);
      const Vec3 normal = side ? direction : Vec3(-direction);
      polytope.faces.push_back({normal, normal.dot(polytope.vertices[loop[0]]), loop});
    }
    for (const std::size_t start : {std::size_t{0}, next, last, next | last})
      polytope.edges.push_back({start, start | bit});
  }
  return polytope;
}

SurfacePoint nearestSurfacePoint(const Polytope& polytope, const Vec3& point) {
  // Inside, the nearest face's plane is nearest; outside, the nearest of the faces that see the point.
  SurfacePoint result;
  result.distance = -std::numeric_limits<double>::infinity();
  for (const Polytope::Face& face : polytope.faces) {
    const double height = face.normal.dot(point) - face.offset;
    if (height > result.distance) result = {height, point - height * face.normal, face.normal, kFlat};
  }
  if (result.distance <= 0) return result;
  double least = std::numeric_limits<double>::infinity();
  for (const Polytope::Face& face : polytope.faces) {
    if (face.normal.dot(point) - face.offset <= 0) continue;
    const auto [nearest, radius] = nearestOnFace(polytope, face, point);
    const double distance = (point - nearest).norm();
    if (distance >= least) continue;
    least = distance;
    result = {distance, nearest, (point - nearest) / distance, radius};
  }
  return result;
}

}  // namespace cradle
