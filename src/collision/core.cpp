#include "collision/core.h"

#include <cmath>

namespace cradle {
namespace {

constexpr double kPerpendicularCosine = 1e-15;  // ten unit roundoffs: as near to perpendicular as rounding allows

}  // namespace

Core::Core(const Collider& collider, const RigidTransform& frameFromCollider)
    : collider_(collider), turn_(frameFromCollider.rotation.toRotationMatrix()), shift_(frameFromCollider.translation) {
  if (collider.points.size() != 2) return;
  const Vec3 from = placed(collider.points[1]), to = placed(collider.points[0]);
  center_ = (from + to) / 2;
  halfLength_ = (to - from).norm() / 2;
  if (halfLength_ > 0) axis_ = (to - from) / (2 * halfLength_);
}

Vec3 Core::supportPoint(const Vec3& direction) const {
  switch (collider_.kind()) {
    case ColliderKind::sphere:
      return placed(collider_.points[0]);
    case ColliderKind::capsule:
      return end(axis_.dot(direction) < 0 ? -1 : 1);
    case ColliderKind::cylinder:
      return rimPoint(axis_.dot(direction) < 0 ? -1 : 1, direction);
    case ColliderKind::polytope:
    case ColliderKind::mesh:
      break;
  }
  const Polytope& polytope = *collider_.polytope;
  lastVertex_ = supportVertex(polytope, turnedBack(direction), lastVertex_);
  return placed(polytope.vertices[lastVertex_]);
}

Vec3 Core::rimPoint(double side, const Vec3& direction) const {
  return end(side) + rimRadius() * unitAcross(axis_, direction);
}

Vec3 unitAcross(const Vec3& axis, const Vec3& direction) {
  // Gram-Schmidt twice: the part of a direction across an axis that it nearly follows is rounding, which may have any
  // direction.
  Vec3 aside = direction - axis.dot(direction) * axis;
  const double length = aside.norm();
  if (!(length > 0)) return axis.unitOrthogonal();
  aside /= length;
  const double along = axis.dot(aside);
  if (std::abs(along) < kPerpendicularCosine) return aside;
  if (std::abs(along) > 0.5) return axis.unitOrthogonal();
  return (aside - along * axis).normalized();
}

}  // namespace cradle
