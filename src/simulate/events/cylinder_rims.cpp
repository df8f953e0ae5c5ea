#include "simulate/events/cylinder_rims.h"

#include <algorithm>
#include <cmath>

#include "collision/core.h"
#include "simulate/events/event_tolerances.h"

namespace cradle {

void moveToRim(const ContactGeometry& geometry, const VectorX& state, Contact& contact) {
  if (std::isnan(contact.radiusA) || std::isnan(contact.radiusB)) rollOnRim(geometry, state, contact);
}

bool rollOnRim(const ContactGeometry& geometry, const VectorX& state, Contact& contact) {
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const bool isOnB = std::isinf(contact.radiusB);  // the face
  if (isOnB == std::isinf(contact.radiusA)) return false;
  const Collider& cylinder = geometry.colliders[isOnB ? pair.a : pair.b];
  if (cylinder.kind() != ColliderKind::cylinder) return false;
  if (!pair.againstPlane && geometry.colliders[isOnB ? pair.b : pair.a].kind() == ColliderKind::mesh) return false;
  const Core core(cylinder, poseOf(state, cylinder.body));
  const Vec3 down = isOnB ? contact.normal : Vec3(-contact.normal);
  if (core.axis().cross(down).norm() < kFlatRim) return false;
  const double side = core.axis().dot(contact.point - core.center()) < 0 ? -1 : 1;
  contact.point = core.rimPoint(side, down) + contact.separation / 2 * down;
  (isOnB ? contact.radiusA : contact.radiusB) = cylinder.rimRadius, contact.rimAxis = core.axis();
  return true;
}

bool isSameRim(const Contact& one, const Contact& other) {
  return one.pair == other.pair && !one.rimAxis.isZero(0) && one.rimAxis == other.rimAxis &&
         (one.point - other.point).norm() < EventTolerances::kSameCorner * std::min(one.radiusA, one.radiusB);
}

bool standsOnRim(const ContactGeometry& geometry, const Contact& contact) {
  if (!contact.rimAxis.isZero(0)) return false;  // it rolls on the rim
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const auto isCylinder = [&](std::size_t collider) {
    return geometry.colliders[collider].kind() == ColliderKind::cylinder;
  };
  return (isCylinder(pair.a) && std::isfinite(contact.radiusA) && contact.lineA.isZero(0)) ||
         (!pair.againstPlane && isCylinder(pair.b) && std::isfinite(contact.radiusB) && contact.lineB.isZero(0));
}

bool standsOnEnd(const ContactGeometry& geometry, const Contact& contact) {
  return standsOnRim(geometry, contact) && std::min(contact.radiusA, contact.radiusB) == 0;
}

double tippingSpeed(const ContactGeometry& geometry, const VectorX& state, const Contact& contact) {
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const bool isA = geometry.colliders[pair.a].kind() == ColliderKind::cylinder && std::isfinite(contact.radiusA);
  const Collider& cylinder = geometry.colliders[isA ? pair.a : pair.b];
  const auto angularVelocityOf = [&](int body) -> Vec3 {
    return body == kFixed ? Vec3(Vec3::Zero()) : Vec3(angularVelocity(state, body));
  };
  const Vec3 axis = Core(cylinder, poseOf(state, cylinder.body)).axis();
  const Vec3 axisVelocity = (angularVelocityOf(contact.bodyA) - angularVelocityOf(contact.bodyB)).cross(axis);  // 1/s
  const bool isLying = std::abs(axis.dot(contact.normal)) < 0.5;
  return cylinder.boundingRadius * (isLying ? std::abs(axisVelocity.dot(contact.normal)) : axisVelocity.norm());
}

}  // namespace cradle
