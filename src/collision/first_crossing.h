#pragma once

#include <optional>

namespace cradle {

constexpr double kFinestCrossing = 1e-12;       // of a step: to this the instant of a crossing is found
constexpr double kFinestApproach = 1.0 / 4096;  // of a step: a touch that comes and goes within less is passed over

/// First zero of `gap(fraction)` in [from, to], given the gap at both ends, gapFrom > 0; `speed` bounds its slope. The
/// interval is passed over when the gap at both its ends is larger than what the fastest approach could close; else it
/// is halved, the earlier half first.
template <class Gap>
std::optional<double> firstCrossing(const Gap& gap, double speed, double from, double gapFrom, double to,
                                    double gapTo) {
  const bool crosses = gapTo <= 0;
  if (!crosses && (gapFrom + gapTo > speed * (to - from) || to - from < kFinestApproach)) return std::nullopt;
  if (crosses && to - from < kFinestCrossing) return to;
  const double middle = from + (to - from) / 2, gapMiddle = gap(middle);
  if (const auto crossing = firstCrossing(gap, speed, from, gapFrom, middle, gapMiddle)) return crossing;
  if (gapMiddle <= 0) return middle;
  return firstCrossing(gap, speed, middle, gapMiddle, to, gapTo);
}

}  // namespace cradle
