#include "simulate/events/touching_contacts.h"

#include <algorithm>
#include <cmath>

#include "collision/core.h"
#include "impact/contact_impulse.h"
#include "simulate/events/cylinder_rims.h"

namespace cradle {
namespace {

/// Whether a collider with corners has one at `point` (m, world).
bool hasCornerAt(const Collider& collider, const Vec3& point, const VectorX& state) {
  if (collider.radius > 0) return false;
  const Vec3 local = poseOf(state, collider.body).inverse() * point;
  const double near = EventTolerances::kSameCorner * collider.boundingRadius;
  if (collider.kind() == ColliderKind::cylinder) {  // any point of a rim
    const Core core(collider, {});
    const double side = core.axis().dot(local - core.center()) < 0 ? -1 : 1;
    return (core.rimPoint(side, local - core.center()) - local).squaredNorm() < near * near;
  }
  return std::any_of(collider.points.begin(), collider.points.end(),
                     [&](const Vec3& corner) { return (corner - local).squaredNorm() < near * near; });
}

/// Where two flat faces touch, a contact may be a corner of either of them; where their edges cross it is none.
void findCorner(const ContactGeometry& geometry, const VectorX& state, Contact& contact) {
  const ColliderPair& pair = geometry.pairs[contact.pair];
  const double least = std::min(contact.radiusA, contact.radiusB), most = std::max(contact.radiusA, contact.radiusB);
  if (pair.againstPlane || least != 0 || !std::isinf(most)) return;
  contact.radiusA = contact.radiusB = INFINITY;
  if (hasCornerAt(geometry.colliders[pair.a], contact.point, state))
    contact.radiusA = 0;
  else if (hasCornerAt(geometry.colliders[pair.b], contact.point, state))
    contact.radiusB = 0;
}

/// Contacts within the touch tolerance, and the nearest of the pair that an event has brought together: its gap may be
/// known less well than to that tolerance.
std::vector<Contact> findNear(const IslandState& island, const EventTolerances& tolerances,
                              const std::optional<std::size_t>& closingPair) {
  const ContactGeometry& geometry = island.assembly.geometry;
  std::vector<Contact> touching, near;
  findContacts(geometry, island.state, tolerances.touch, touching);
  const auto isOfPair = [&](const Contact& contact) { return contact.pair == *closingPair; };
  if (!closingPair || std::any_of(touching.begin(), touching.end(), isOfPair)) return touching;
  appendContacts(geometry, *closingPair, island.state, tolerances.closingPairGap, near);
  const auto nearest = std::min_element(near.begin(), near.end(), [](const Contact& left, const Contact& right) {
    return left.separation < right.separation;
  });
  if (nearest != near.end()) touching.push_back(*nearest);
  return touching;
}

}  // namespace

std::vector<Contact> findTouching(const IslandState& island, ConstraintSolver& constraints,
                                  const EventTolerances& tolerances, const std::optional<std::size_t>& closingPair) {
  const ContactGeometry& geometry = island.assembly.geometry;
  std::vector<Contact> touching = findNear(island, tolerances, closingPair);
  island.requireRoom(
      eraseImmobile(ImpulseResponse(island.assembly.mechanism.bodies, constraints), island.state, touching),
      tolerances.minOpeningSpeed(tolerances.scales.size));
  for (Contact& contact : touching) findCorner(geometry, island.state, contact);
  for (Contact& contact : touching) moveToRim(geometry, island.state, contact);
  touching.erase(std::unique(touching.begin(), touching.end(), isSameRim), touching.end());
  return touching;
}

}  // namespace cradle
