#pragma once

#include <vector>

#include "impact/pairwise.h"

namespace cradle {

/// Simultaneous impact without friction: all contacts that close are reflected at once, again and again until none
/// closes. Symmetry is kept, and what one sphere hits in a row of touching spheres leaves at the row's other end.
/// Energy is kept if all restitutions are 1, and never gained; the result is a continuous function of the restitutions.
/// Friction of the laws is not looked at. The bodies' constraints take part. O(contacts) applications of `response`,
/// O(contacts^3) a reflection.
void resolveReflections(std::vector<ImpactContact>& impacts, const ImpulseResponse& response, VectorX& state);

/// A part (0..1) of an impact, in which contacts either rebound fully or not at all; its impulses (N s) along the
/// normals, as if it were the whole.
struct Rebound {
  double part;
  VectorX impulses;
};

/// The parts of an impact in which something rebounds, for contacts whose normals answer to impulses with `delassus`
/// (1/kg) and open with `speeds` (m/s). What all of them leave of 1 is the part of the impact without rebound.
std::vector<Rebound> reboundsOf(const MatrixX& delassus, const VectorX& speeds,
                                const std::vector<ImpactContact>& impacts);

}  // namespace cradle
