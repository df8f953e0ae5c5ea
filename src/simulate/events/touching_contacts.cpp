#include "simulate/events/touching_contacts.h"

#include <algorithm>
#include <cmath>

#include "impact/contact_impulse.h"
#include "simulate/events/contact_features.h"
#include "simulate/events/cylinder_rims.h"

namespace cradle {
namespace {

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
  findFeatures(geometry, island.state, tolerances.leaving, touching);
  for (Contact& contact : touching) moveToRim(geometry, island.state, contact);
  touching.erase(std::unique(touching.begin(), touching.end(), isSameRim), touching.end());
  return touching;
}

}  // namespace cradle
