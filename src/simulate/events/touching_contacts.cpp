#include "simulate/events/touching_contacts.h"

#include <algorithm>
#include <cmath>
#include <optional>

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

/// Erases the contacts that constraints let neither open nor close, which `constraints` has factorised for the state.
/// Taut ropes and stops hold one way only: contacts that close, and that these alone hold, stay, as the impact may let
/// the limits go. Throws Error(unstable) for those of driven bodies that close and that nothing lets go.
void eraseHeld(const IslandState& island, ConstraintSolver& constraints, double still, std::vector<Contact>& contacts) {
  const std::vector<RigidBody>& bodies = island.assembly.mechanism.bodies;
  const ImpulseResponse response(bodies, constraints);
  const bool hasLimits = island.assembly.names.constraints.size() < island.assembly.mechanism.constraints.size();
  Constraints ties;
  std::optional<ConstraintSolver> tieSolver;
  const auto isHeldByTies = [&](const Contact& contact) {
    if (!tieSolver) {
      ties = tiesOf(island.assembly);
      tieSolver.emplace(ties, bodies);
      if (tieSolver->hasConstraints()) tieSolver->factorize(island.state);
    }
    return isImmobile(contact, ImpulseResponse(bodies, *tieSolver), island.state);
  };
  std::erase_if(contacts, [&](const Contact& contact) {
    if (!isImmobile(contact, response, island.state)) return false;
    const bool closes = openingSpeed(contact, island.state) < -still;
    if (closes && hasLimits && !isHeldByTies(contact)) return false;
    if (closes && !island.assembly.mechanism.driven.empty()) island.failAtNoRoom(contact);
    return true;
  });
}

}  // namespace

std::vector<Contact> findTouching(const IslandState& island, ConstraintSolver& constraints,
                                  const EventTolerances& tolerances, const std::optional<std::size_t>& closingPair) {
  const ContactGeometry& geometry = island.assembly.geometry;
  std::vector<Contact> touching = findNear(island, tolerances, closingPair);
  if (constraints.hasConstraints())
    eraseHeld(island, constraints, tolerances.minOpeningSpeed(tolerances.scales.size), touching);
  findFeatures(geometry, island.state, tolerances.leaving, touching);
  for (Contact& contact : touching) moveToRim(geometry, island.state, contact);
  touching.erase(std::unique(touching.begin(), touching.end(), isSameRim), touching.end());
  island.requireComparableMasses(touching);
  return touching;
}

}  // namespace cradle
