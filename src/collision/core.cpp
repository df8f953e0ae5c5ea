#include "collision/core.h"

namespace cradle {

Core::Core(const Collider& collider, const RigidTransform& frameFromCollider)
    : collider_(collider), turn_(frameFromCollider.rotation.toRotationMatrix()), shift_(frameFromCollider.translation) {
  if (collider.points.size() != 2) return;
  const Vec3 from = placed(collider.points[1]), to = placed(collider.points[0]);
  center_ = (from + to) / 2;
  halfLength_ = (to - from).norm() / 2;
  if (halfLength_ > 0) axis_ = (to - from) / (2 * halfLength_);
}

Vec3 Core::farthest(const Vec3& direction) const {
  switch (collider_.kind()) {
    case ColliderKind::ball:
      return placed(collider_.points[0]);
    case ColliderKind::capsule:
      return end(axis_.dot(direction) < 0 ? -1 : 1);
    case ColliderKind::cylinder:
      return rimPoint(axis_.dot(direction) < 0 ? -1 : 1, direction);
    case ColliderKind::polytope:
      break;
  }
  const Polytope& polytope = *collider_.polytope;
  return placed(polytope.vertices[farthestVertex(polytope, turnedBack(direction))]);
}

Vec3 Core::rimPoint(double side, const Vec3& direction) const {
  const Vec3 across = direction - axis_.dot(direction) * axis_;
  const double length = across.norm();
  const Vec3 radial = length > 0 ? Vec3(across / length) : axis_.unitOrthogonal();
  return end(side) + rimRadius() * radial;
}

}  // namespace cradle
