#pragma once

#include <limits>

#include "collision/core.h"

namespace cradle {

/// The result of the algorithm of Gilbert, Johnson and Keerthi (GJK) for two cores.
struct GjkResult {
  double distance = 0;         // m; 0: they overlap, or touch to rounding
  Vec3 normal = Vec3::Zero();  // unit, from A to B; zero if they overlap
  double lowerBound = 0;       // m: gap that `normal` sees, at most the distance. Less than it if a core is round, by
                               // about 1e-6 of it, and where faces are nearly parallel
  Vec3 onA = Vec3::Zero(), onB = Vec3::Zero();  // m: nearest points
};

/// Distance of two cores in a common frame, by GJK. 10 to 40 support points of each core are searched; fewer where the
/// lower bound exceeds `enough` (m), with which the search ends.
GjkResult distanceOf(const Core& a, const Core& b, double enough = std::numeric_limits<double>::infinity());

/// Gap (m) between two cores that a unit normal sees: at most their distance, at least minus their overlap.
inline double gapAlong(const Core& a, const Core& b, const Vec3& normal) {
  return normal.dot(b.supportPoint(-normal) - a.supportPoint(normal));
}

}  // namespace cradle
