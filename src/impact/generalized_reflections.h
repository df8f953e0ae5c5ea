#pragma once

#include <vector>

#include "impact/pairwise.h"

namespace cradle {

/// Simultaneous impact without friction: all contacts that close are reflected at once, again and again until none
/// closes. Symmetry is kept, and what one ball hits in a row of touching balls leaves at the row's other end. Energy
/// is kept if all restitutions are 1, and never gained. Friction of the laws is not looked at. What ties the bodies
/// takes part. Throws Error(unstable) if it does not come to an end. O(contacts) applications of `response`,
/// O(contacts^3) a reflection.
void resolveReflections(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state);

/// The impulses (N s) along the normals by the same law, for contacts whose normals answer to them with `inverseMass`
/// (1/kg) and open with `speeds` (m/s). O(contacts^3) a reflection.
VectorX reflectionImpulses(const MatrixX& inverseMass, const VectorX& speeds,
                           const std::vector<ImpactContact>& impacts);

}  // namespace cradle
