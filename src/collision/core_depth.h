#pragma once

#include "collision/separating_axis.h"

namespace cradle {

/// The direction that sees the largest gap between two cores of which one has a rim, and that gap: minus the least
/// translation that separates them if they overlap. Of ways out that differ by less than 1/1000 either may be taken.
/// Holds for cores that touch or are just apart, too. Some 20 to 100 searches for farthest points.
SeparatingAxis deepestAxis(const Core& a, const Core& b);

}  // namespace cradle
