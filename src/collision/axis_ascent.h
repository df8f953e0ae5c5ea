#pragma once

#include "collision/separating_axis.h"

namespace cradle {

/// The direction uphill from a given one that sees the largest gap between two cores: of cores that are apart their
/// distance, else a local maximum. The separation of `axis` need not be set. A gap of `enough` (m) that features near
/// the direction do not exceed is not doubted.
SeparatingAxis improved(const SeparatingAxis& axis, const Core& a, const Core& b,
                        double enough = std::numeric_limits<double>::infinity());

/// A unit vector across two directions that may be nearly parallel; zero if they are to rounding.
Vec3 across(const Vec3& directionA, const Vec3& directionB);

}  // namespace cradle
