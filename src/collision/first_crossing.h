#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cradle {

constexpr double kFinestCrossing = 1e-12;       // of a step: to this the instant of a crossing is found
constexpr double kFinestApproach = 1.0 / 4096;  // of a step: a touch that comes and goes within less is passed over

/// What is known of a gap over a whole step: |gap'| <= speed, gap'' <= acceleration; the unit of time is the step.
struct GapBounds {
  double speed = 0;
  double acceleration = std::numeric_limits<double>::infinity();
};

/// A gap with these values at the ends of an interval of that length cannot close inside it: the fastest approach does
/// not suffice, or the parabola under its chord stays above 0.
inline bool staysOpen(const GapBounds& bounds, double gapFrom, double gapTo, double length) {
  if (gapFrom + gapTo > bounds.speed * length) return true;
  const double sag = bounds.acceleration * length * length / 8, slant = std::abs(gapTo - gapFrom);
  if (slant >= 4 * sag) return true;  // the parabola is lowest at an end
  return (gapFrom + gapTo) / 2 - sag - slant * slant / (16 * sag) > 0;
}

/// First zero of `gap(fraction)` in [from, to], given the gap at both ends, gapFrom > 0. An interval in which the gap
/// stays open is passed over; else it is halved, the earlier half first.
template <class Gap>
std::optional<double> firstCrossing(const Gap& gap, const GapBounds& bounds, double from, double gapFrom, double to,
                                    double gapTo) {
  const bool crosses = gapTo <= 0;
  if (!crosses && (staysOpen(bounds, gapFrom, gapTo, to - from) || to - from < kFinestApproach)) return std::nullopt;
  if (crosses && to - from < kFinestCrossing) return to;
  const double middle = from + (to - from) / 2, gapMiddle = gap(middle);
  if (const auto crossing = firstCrossing(gap, bounds, from, gapFrom, middle, gapMiddle)) return crossing;
  if (gapMiddle <= 0) return middle;
  return firstCrossing(gap, bounds, middle, gapMiddle, to, gapTo);
}

}  // namespace cradle
