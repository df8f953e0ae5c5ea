#pragma once

#include "collision/separating_axis.h"

namespace cradle {

/// Signed distance of two convex cores in a common frame, and the normal that sees it: the distance where they are
/// apart, minus the least translation that separates them where they overlap; continuous in between. For two polytopes,
/// segments or points exact to rounding. With rims the distance is good to 1e-12 of the size but for one pose in 10000
/// (to 1e-9); of ways out that differ by less than 1/1000 either may be taken.
SeparatingAxis separationOf(const Core& a, const Core& b);

/// The same for contact: where several directions see the same gap up to 1e-7 of the size, one that is normal to a face
/// is taken; where corners meet to 1e-9 of it, one that turns and mirrors with the cores.
SeparatingAxis contactAxis(const Core& a, const Core& b);

}  // namespace cradle
