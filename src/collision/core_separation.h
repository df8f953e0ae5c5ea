#pragma once

#include "collision/separating_axis.h"

namespace cradle {

/// Signed distance of two convex cores in a common frame, neither of them a point, and the normal that sees it: the
/// distance of cores that are apart, or minus the length of the least translation that separates cores that overlap;
/// continuous in between. Between polytopes and segments it is exact to rounding. With rims the distance has an error
/// of 1e-12 of the size, in one pose of 10000 of 1e-9; of two translations whose lengths differ by less than 1/1000
/// either may be taken.
SeparatingAxis separationOf(const Core& a, const Core& b);

/// The same for contact. Where several directions see the same gap, to 1e-7 of the size, a face's normal is taken;
/// where corners meet, to 1e-9 of the size, or overlap, to 1e-4, a direction that turns and mirrors with the cores.
SeparatingAxis contactAxis(const Core& a, const Core& b);

/// The same where the face that contactAxis prefers has nothing over it: no face is preferred.
SeparatingAxis axisBesideFaces(const Core& a, const Core& b);

}  // namespace cradle
