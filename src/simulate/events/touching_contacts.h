#pragma once

#include <optional>
#include <vector>

#include "constraints/constraint_forces.h"
#include "simulate/island_state.h"

namespace cradle {

/// How near bodies have to be at an event; m, of the smallest body's size.
struct TouchTolerances {
  double size = 0;      // of the smallest body
  double touch = 0;     // nearer is touching
  double deadBand = 0;  // how far a contact without load may sink before it counts as a new impact
  double reach = 0;     // of the contacts that may take part in a sequence of impacts
};

/// The tolerances of an island at an accuracy (m).
TouchTolerances touchTolerancesOf(const ContactGeometry& geometry, double accuracy);

/// The contacts that touch in the island's state and can open or close: constraints keep others where they are,
/// whatever acts. `closingPair`, whose gap an event has closed, touches in any case, by its nearest point. Where two
/// flat faces touch, contacts are corners of either; a tilted cylinder touches a plane by the lowest point of its rim.
/// `constraints` must be factorised for the state.
std::vector<Contact> findTouching(const IslandState& island, ConstraintSolver& constraints,
                                  const TouchTolerances& tolerances, const std::optional<std::size_t>& closingPair);

}  // namespace cradle
