#include "simulate/events/touching_contacts.h"

#include <algorithm>
#include <cmath>

#include "collision/core.h"
#include "impact/contact_impulse.h"
#include "simulate/events/cylinder_rims.h"
#include "simulate/plan/plan.h"

namespace cradle {
namespace {

// Nearer (in sizes of a body) is touching: hardly more than rounding, whatever the accuracy, as a small gap and none
// may have entirely different consequences. Visual accuracies take more together.
constexpr double kTouchRatio = 1e-11;
constexpr double kVisualTouchRatio = 1e-8;
// In a sequence of impacts bodies move so far at most while normals stay as they are; farther at visual accuracies, as
// events are counted there.
constexpr double kReachRatio = 0.1;  // of the accuracy
constexpr double kMaxReachRatio = 1e-8;
constexpr double kMaxVisualReachRatio = 1e-5;
constexpr double kMaxTouchError = 1e-6;   // of a size: so well two ways to find a gap agree
constexpr double kDeadBandRatio = 1e-12;  // of the smallest size
constexpr double kSameCorner = 1e-6;      // of a size

/// Whether a collider with corners has one at `point` (m, world).
bool hasCornerAt(const Collider& collider, const Vec3& point, const VectorX& state) {
  if (collider.radius > 0) return false;
  const Vec3 local = poseOf(state, collider.body).inverse() * point;
  const double near = kSameCorner * collider.boundingRadius;
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
std::vector<Contact> findNear(const IslandState& island, const TouchTolerances& tolerances,
                              const std::optional<std::size_t>& closingPair) {
  const ContactGeometry& geometry = island.assembly.geometry;
  std::vector<Contact> touching, near;
  findContacts(geometry, island.state, tolerances.touch, touching);
  const auto isOfPair = [&](const Contact& contact) { return contact.pair == *closingPair; };
  if (!closingPair || std::any_of(touching.begin(), touching.end(), isOfPair)) return touching;
  appendContacts(geometry, *closingPair, island.state, kMaxTouchError * tolerances.size, near);
  const auto nearest = std::min_element(near.begin(), near.end(), [](const Contact& left, const Contact& right) {
    return left.separation < right.separation;
  });
  if (nearest != near.end()) touching.push_back(*nearest);
  return touching;
}

}  // namespace

TouchTolerances touchTolerancesOf(const ContactGeometry& geometry, double accuracy) {
  const bool isVisual = accuracy > kVisualAccuracy;
  const double size = smallestSize(geometry);
  const double reach =
      std::clamp(kReachRatio * accuracy, kTouchRatio, isVisual ? kMaxVisualReachRatio : kMaxReachRatio);
  return {size, size * (isVisual ? kVisualTouchRatio : kTouchRatio), kDeadBandRatio * size, size * reach};
}

std::vector<Contact> findTouching(const IslandState& island, ConstraintSolver& constraints,
                                  const TouchTolerances& tolerances, const std::optional<std::size_t>& closingPair) {
  const ContactGeometry& geometry = island.assembly.geometry;
  std::vector<Contact> touching = findNear(island, tolerances, closingPair);
  eraseImmobile(ImpulseResponse(island.assembly.mechanism.bodies, constraints), island.state, touching);
  for (Contact& contact : touching) findCorner(geometry, island.state, contact);
  for (Contact& contact : touching) moveToRim(geometry, island.state, contact);
  touching.erase(std::unique(touching.begin(), touching.end(), isSameRim), touching.end());
  return touching;
}

}  // namespace cradle
