#pragma once

#include "collision/separating_axis.h"

namespace cradle {

/// The direction that sees the largest gap between two cores of which one has a rim, and that gap; if they overlap,
/// minus the length of the least translation that separates them. Of two translations whose lengths differ by less than
/// 1/1000 either may be taken. The cores may also touch, or be just apart. By the expanding polytope algorithm (EPA),
/// which searches 20 to 100 support points of each core.
SeparatingAxis deepestAxis(const Core& a, const Core& b);

}  // namespace cradle
