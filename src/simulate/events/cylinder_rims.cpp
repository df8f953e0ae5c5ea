#include "simulate/events/cylinder_rims.h"

#include <algorithm>
#include <cmath>

#include "collision/core.h"
#include "simulate/events/event_tolerances.h"

namespace cradle {

void moveToRim(const ContactGeometry& geometry, const VectorX& state, Contact& contact) {
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const Collider& cylinder = geometry.colliders[pair.a];
  if (!pair.againstPlane || cylinder.kind() != ColliderKind::cylinder || !std::isnan(contact.radiusA)) return;
  const Core core(cylinder, poseOf(state, cylinder.body));
  if (core.axis().cross(contact.normal).norm() < kFlatRim) return;
  const double side = core.axis().dot(contact.point - core.center()) < 0 ? -1 : 1;
  const Vec3 lowest = core.rimPoint(side, contact.normal);
  contact.point = lowest + contact.separation / 2 * contact.normal;
  contact.radiusA = cylinder.rimRadius, contact.rimAxisA = core.axis();
}

bool isSameRim(const Contact& one, const Contact& other) {
  return one.pair == other.pair && !one.rimAxisA.isZero(0) && one.rimAxisA == other.rimAxisA &&
         (one.point - other.point).norm() < EventTolerances::kSameCorner * one.radiusA;
}

bool standsOnRim(const ContactGeometry& geometry, const Contact& contact) {
  if (!contact.rimAxisA.isZero(0)) return false;  // it rolls on the rim
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
