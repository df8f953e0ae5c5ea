#pragma once

#include <vector>

#include "impact/pairwise.h"

namespace cradle {

/// Simultaneous impact with friction: all contacts that close, and those that touch without rebound, get impulses
/// within Coulomb's cones at once, again and again until none closes. Symmetry is kept, the order of contacts does not
/// count, energy is never gained: a restitution that would is made smaller. What ties the bodies takes part.
/// O(contacts^3) a round, few rounds unless elastic bodies stand in a row.
ImpactFaults resolveFrictionalImpact(std::vector<ImpactContact>& impacts, const ImpulseResponse& response,
                                     VectorX& state);

}  // namespace cradle
