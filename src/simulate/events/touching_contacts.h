#pragma once

#include <optional>
#include <vector>

#include "constraints/constraint_forces.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/island_state.h"

namespace cradle {

/// The contacts that touch in the island's state and can open or close: constraints keep others where they are,
/// whatever acts. `closingPair`, whose gap an event has closed, touches in any case, by its nearest point. The features
/// that touch are told (contact_features.h); a tilted cylinder touches a plane by the lowest point of its rim.
/// `constraints` must be factorised for the state.
std::vector<Contact> findTouching(const IslandState& island, ConstraintSolver& constraints,
                                  const EventTolerances& tolerances, const std::optional<std::size_t>& closingPair);

}  // namespace cradle
