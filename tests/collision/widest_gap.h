#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "math/types.h"

namespace cradle {

/// How thoroughly directions are searched.
struct SearchEffort {
  int directions;      // of a spiral over the sphere,
  std::size_t climbs;  // from so many of the best of which it goes uphill,
  double lastStep;     // rad: by steps down to this
};

/// Climbs from a direction by ever smaller steps to all sides.
template <class Gap>
Vec3 climbed(const Gap& gapAlong, Vec3 direction, double lastStep) {
  double gap = gapAlong(direction);
  for (double step = 0.1; step > lastStep;) {
    const Vec3 side = direction.unitOrthogonal(), other = direction.cross(side);
    bool better = false;
    for (int k = 0; k < 16 && !better; ++k) {
      const double angle = k * M_PI / 8;
      const Vec3 tried = (direction + step * (std::cos(angle) * side + std::sin(angle) * other)).normalized();
      const double found = gapAlong(tried);
      if (found > gap) gap = found, direction = tried, better = true;
    }
    if (!better) step /= 2;
  }
  return direction;
}

/// The unit vector n of the largest gapAlong(n): knows nothing of what the gap is between.
template <class Gap>
Vec3 widestGap(const Gap& gapAlong, const SearchEffort& effort) {
  std::vector<std::pair<double, Vec3>> tried;
  for (int i = 0; i < effort.directions; ++i) {
    const double y = 1 - (2 * i + 1.0) / effort.directions, ring = std::sqrt(1 - y * y);
    const double angle = i * M_PI * (3 - std::sqrt(5));
    const Vec3 direction(ring * std::cos(angle), y, ring * std::sin(angle));
    tried.emplace_back(gapAlong(direction), direction);
  }
  std::partial_sort(tried.begin(), tried.begin() + static_cast<std::ptrdiff_t>(effort.climbs), tried.end(),
                    [](const auto& left, const auto& right) { return left.first > right.first; });
  Vec3 best = tried[0].second;
  for (std::size_t i = 0; i < effort.climbs; ++i) {
    const Vec3 top = climbed(gapAlong, tried[i].second, effort.lastStep);
    if (gapAlong(top) > gapAlong(best)) best = top;
  }
  return best;
}

}  // namespace cradle
