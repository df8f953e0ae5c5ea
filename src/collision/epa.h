#pragma once

#include "collision/separating_axis.h"

namespace cradle {

/// The direction that sees the largest gap between two cores of which one has a rim, and that gap: minus the least
/// translation that separates them if they overlap. Of ways out that differ by less than 1/1000 either may be taken.
/// Holds for cores that touch or are just apart, too. By the expanding polytope algorithm (EPA); 20 to 100 support
/// points of each core are searched.
SeparatingAxis deepestAxis(const Core& a, const Core& b);

}  // namespace cradle
