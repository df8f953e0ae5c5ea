#pragma once

#include "collision/separating_axis.h"

namespace cradle {

/// The direction near a given one that sees the largest gap between two cores. Exact: of cores that are apart, their
/// distance, if the given one is about that of the nearest points; else a local maximum. The separation of `axis` need
/// not be set.
SeparatingAxis improved(SeparatingAxis axis, const Core& a, const Core& b);

/// A unit vector across two directions that may be nearly parallel; zero if they are to rounding.
Vec3 across(const Vec3& directionA, const Vec3& directionB);

}  // namespace cradle
