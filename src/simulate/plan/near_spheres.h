#pragma once

#include <functional>
#include <vector>

#include "simulate/plan/reach.h"

namespace cradle {

/// Calls visit(i, j) once for each pair of spheres that may overlap, and for some others, in any order, until it
/// returns false. O(n log n) where none overlaps many of its own size or larger; a factor of the number of different
/// sizes, to a power of two.
void forEachNearPair(const std::vector<Reach>& spheres, const std::function<bool(std::size_t, std::size_t)>& visit);

}  // namespace cradle
