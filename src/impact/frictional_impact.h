#pragma once

#include <vector>

#include "impact/pairwise.h"

namespace cradle {

/// Simultaneous impact with friction: all contacts that touch get impulses within Coulomb's cones at once, and open as
/// they do without friction. Symmetry is kept, the order of contacts does not count, energy is never gained: a
/// restitution that would is made smaller, no more than it must. The bodies' constraints take part. O(contacts^3) for
/// each reflection without friction and each of a few frictional contact problems.
ImpactFaults resolveFrictionalImpact(std::vector<ImpactContact>& impacts, const ImpulseResponse& response,
                                     VectorX& state);

}  // namespace cradle
