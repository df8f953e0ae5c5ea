#pragma once

#include "collision/separating_axis.h"

namespace cradle {

/// Hill climbing on the support gap g(n) = -h_A(n) - h_B(-n) of two cores, from the direction of `axis`: the local
/// maximum that it leads to. Of cores that are apart this is their distance, if it begins within 0.1 rad of the
/// direction between their nearest points; from farther aside it may end before. The separation of `axis` need not be
/// set. A gap of `enough` (m) that features near the direction do not exceed is not doubted.
SeparatingAxis climbedSupportGap(const SeparatingAxis& axis, const Core& a, const Core& b,
                                 double enough = std::numeric_limits<double>::infinity());

/// A unit vector across two directions that may be nearly parallel; zero if they are to rounding.
Vec3 across(const Vec3& directionA, const Vec3& directionB);

}  // namespace cradle
