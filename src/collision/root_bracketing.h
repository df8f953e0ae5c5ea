#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

namespace cradle {

// Of a step: width to which a bracket is closed. Gaps that change by their size in a step are then known to 1e-12 of
// the size, a tenth of the tolerance for touching at an event (kTouchRatio, 1e-11). Ten times as much misses instants
// that tests know in closed form.
constexpr double kRootTolerance = 1e-12;
// Of a step: touches that come and go within less are passed over, with bounds on the gap's acceleration and without.
// With bounds, the overlap inside such an interval is at most acceleration / 8 x 2^-40: of gaps that accelerate by
// their size in a step, a hundredth of the tolerance for touching. Without them, all intervals of that length may have
// to be searched, at the cost of a query each. A tenth or ten times as much changes no test of a search.
constexpr double kFinestApproach = 1.0 / (1 << 20);
constexpr double kFinestBlindApproach = 1.0 / (1 << 12);
// Of three steps, but for the first ones, at least one halves a bracket: 40 halvings leave 1e-12 of it.
constexpr int kMaxBracketSteps = 3 * (1 + 40);

/// Bounds on a gap over a whole step: |gap'| <= speed, gap'' <= acceleration; the unit of time is the step.
struct GapBounds {
  double speed = 0;
  double acceleration = std::numeric_limits<double>::infinity();
  double graze = 0;                 // m: overlaps inside an interval that cannot be deeper are passed over
  double finest = kFinestApproach;  // of a step: shorter intervals are not searched
};

/// Whether a gap g with the values a and b at the ends of an interval of length T cannot close inside it. Either the
/// fastest approach does not suffice, a + b > speed T; or the parabola through both ends with g'' = acceleration, which
/// g is nowhere below, stays above 0. The parabola is below its chord by at most s = acceleration T^2 / 8, and its
/// least value is (a + b) / 2 - s - (b - a)^2 / (16 s) if that is inside the interval, |b - a| < 4 s.
inline bool staysOpen(const GapBounds& bounds, double gapFrom, double gapTo, double length) {
  const double from = gapFrom + bounds.graze, to = gapTo + bounds.graze;
  if (from + to > bounds.speed * length) return true;
  const double sag = bounds.acceleration * length * length / 8, slant = std::abs(to - from);
  if (slant >= 4 * sag) return true;  // the parabola is lowest at an end
  return (from + to) / 2 - sag - slant * slant / (16 * sag) > 0;
}

/// Two fractions of a step, and the gaps there. gapBefore > 0; it brackets a root if gapAfter <= 0.
struct Bracket {
  double before, gapBefore, after, gapAfter;
};

/// The root of the parabola through both ends of a bracket and a third point: there is one in the bracket.
inline double rootOfParabola(const Bracket& bracket, double third, double gapThird) {
  const double width = bracket.after - bracket.before, chord = (bracket.gapAfter - bracket.gapBefore) / width;
  const double secondDifference =
      ((gapThird - bracket.gapBefore) / (third - bracket.before) - chord) / (third - bracket.after);
  const double slope = chord - secondDifference * width,
               discriminant = slope * slope - 4 * secondDifference * bracket.gapBefore;
  return bracket.before + 2 * bracket.gapBefore / (std::sqrt(std::max(0.0, discriminant)) - slope);
}

/// Closes a bracket around a root to a width of `finest` by parabolas (D. E. Muller, "A method for solving algebraic
/// equations using an automatic computer", 1956): the gap of a body in free fall is one. Where three iterations have
/// not halved the bracket, it is bisected.
template <class Gap>
void closeBracket(const Gap& gap, Bracket& bracket, double finest = kRootTolerance) {
  double third = 0, gapThird = 0, widthBefore = INFINITY;
  for (int i = 0; i < kMaxBracketSteps && bracket.after - bracket.before > finest; ++i) {
    const double width = bracket.after - bracket.before;
    double estimate = bracket.before + width * bracket.gapBefore / (bracket.gapBefore - bracket.gapAfter);
    if (i > 0) estimate = rootOfParabola(bracket, third, gapThird);
    if (i % 3 == 2) {
      const bool isBisected = width > widthBefore / 2;
      if (isBisected) estimate = bracket.before + width / 2;
      widthBefore = isBisected ? width / 2 : width;
    }
    // At least half of `finest` inside the bracket, so that both of its ends come to the root.
    if (!(estimate > bracket.before + 0.5 * finest)) estimate = bracket.before + 0.5 * finest;
    if (!(estimate < bracket.after - 0.5 * finest)) estimate = bracket.after - 0.5 * finest;
    const double found = gap(estimate);
    double& end = found > 0 ? bracket.before : bracket.after;
    double& gapEnd = found > 0 ? bracket.gapBefore : bracket.gapAfter;
    third = end, gapThird = gapEnd;
    end = estimate, gapEnd = found;
  }
}

/// A gap at a fraction of a step. A function of two arguments need not look for gaps beyond `enough`.
template <class Gap>
double gapWithin(const Gap& gap, double fraction, double enough) {
  if constexpr (std::is_invocable_v<const Gap&, double, double>)
    return gap(fraction, enough);
  else
    return gap(fraction);
}

/// First root of `gap(fraction)` between the ends, where gapBefore > 0. An interval in which the gap stays open, by its
/// bounds or as `isOpen(ends)` tells, is passed over; any other is halved, and the earlier half is searched first.
/// Where the ends differ in sign their root is found at once, and the interval before it is searched in the same way.
/// In the middle of an interval that may not stay open, no gap exceeds the fastest approach in the whole of it.
template <class Gap, class IsOpen>
std::optional<double> firstRoot(const Gap& gap, const GapBounds& bounds, const IsOpen& isOpen, Bracket ends) {
  if (ends.gapAfter <= 0) {
    Bracket bracket = ends;
    closeBracket(gap, bracket);
    const auto earlier =
        firstRoot(gap, bounds, isOpen, {ends.before, ends.gapBefore, bracket.before, bracket.gapBefore});
    return earlier ? earlier : bracket.after;
  }
  const double length = ends.after - ends.before;
  if (length < bounds.finest || staysOpen(bounds, ends.gapBefore, ends.gapAfter, length)) return std::nullopt;
  if (isOpen(ends)) return std::nullopt;
  const double middle = ends.before + length / 2, gapMiddle = gapWithin(gap, middle, bounds.speed * length);
  if (const auto crossing = firstRoot(gap, bounds, isOpen, {ends.before, ends.gapBefore, middle, gapMiddle}))
    return crossing;
  return firstRoot(gap, bounds, isOpen, {middle, gapMiddle, ends.after, ends.gapAfter});
}

/// The same with nothing known but the bounds.
template <class Gap>
std::optional<double> firstRoot(const Gap& gap, const GapBounds& bounds, const Bracket& ends) {
  return firstRoot(
      gap, bounds, [](const Bracket&) { return false; }, ends);
}

}  // namespace cradle
