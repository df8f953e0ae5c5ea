#include "collision/face_below.h"

namespace cradle {
namespace {

/// How far (m) inside the outline of a face a point is, along the face.
double insideOutline(const Polytope& polytope, const Polytope::Face& face, const Vec3& point) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < face.loop.size(); ++i) {
    const Vec3 &from = polytope.vertices[face.loop[i]], &to = polytope.vertices[face.loop[(i + 1) % face.loop.size()]];
    least = std::min(least, face.normal.cross(to - from).normalized().dot(point - from));
  }
  return least;
}

}  // namespace

std::optional<FaceBelow> faceBelow(const Collider& upper, const RigidTransform& worldFromUpper, const Collider& lower,
                                   const RigidTransform& worldFromLower,
                                   const std::function<double(const Vec3& normal)>& motionAlong) {
  const bool hasPoints = upper.kind() == ColliderKind::sphere || upper.kind() == ColliderKind::capsule ||
                         upper.kind() == ColliderKind::polytope;
  if (upper.body == kFixed || !hasPoints || lower.kind() != ColliderKind::polytope) return std::nullopt;
  const Vec3 center = worldFromLower.inverse() * worldFromUpper.translation;
  for (const Polytope::Face& face : lower.polytope->faces) {
    if (face.normal.dot(center) <= face.offset) continue;
    const double inside = insideOutline(*lower.polytope, face, center) - upper.boundingRadius;
    if (inside < 0 || inside < motionAlong(worldFromLower.rotation * face.normal)) continue;
    return FaceBelow{false, face.normal, lower.polytope->vertices[face.loop[0]]};
  }
  return std::nullopt;
}

double heightOver(const FaceBelow& face, const RigidTransform& worldFromLower, const Vec3& corner) {
  return (worldFromLower.rotation * face.normal).dot(corner - worldFromLower * face.point);
}

}  // namespace cradle
