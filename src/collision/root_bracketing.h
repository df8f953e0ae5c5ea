#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace cradle {

constexpr double kRootTolerance = 1e-12;  // of a step: to this the instant of a root is found
// Of a step: touches that come and go within less are passed over, with bounds on the gap's acceleration and without.
constexpr double kFinestApproach = 1.0 / (1 << 20);
constexpr double kFinestBlindApproach = 1.0 / (1 << 12);
constexpr int kMaxCuts = 100;  // of a bracket; halving alone would need 40

/// What is known of a gap over a whole step: |gap'| <= speed, gap'' <= acceleration; the unit of time is the step.
struct GapBounds {
  double speed = 0;
  double acceleration = std::numeric_limits<double>::infinity();
  double graze = 0;                 // m: touches that come and go and cannot be deeper are passed over
  double finest = kFinestApproach;  // of a step: intervals that are not looked into
};

/// A gap with these values at the ends of an interval of that length cannot close inside it: the fastest approach does
/// not suffice, or the parabola under its chord stays above 0.
inline bool staysOpen(const GapBounds& bounds, double gapFrom, double gapTo, double length) {
  const double from = gapFrom + bounds.graze, to = gapTo + bounds.graze;
  if (from + to > bounds.speed * length) return true;
  const double sag = bounds.acceleration * length * length / 8, slant = std::abs(to - from);
  if (slant >= 4 * sag) return true;  // the parabola is lowest at an end
  return (from + to) / 2 - sag - slant * slant / (16 * sag) > 0;
}

/// Two fractions of a step, and the gaps there: gapBefore > 0. Around a root 0 >= gapAfter.
struct Bracket {
  double before, gapBefore, after, gapAfter;
};

/// Where in a bracket the parabola through its ends and a third point crosses zero: it does so once.
inline double rootOfParabola(const Bracket& bracket, double third, double gapThird) {
  const double width = bracket.after - bracket.before, chord = (bracket.gapAfter - bracket.gapBefore) / width;
  const double secondDifference =
      ((gapThird - bracket.gapBefore) / (third - bracket.before) - chord) / (third - bracket.after);
  const double slope = chord - secondDifference * width,
               root = slope * slope - 4 * secondDifference * bracket.gapBefore;
  return bracket.before + 2 * bracket.gapBefore / (std::sqrt(std::max(0.0, root)) - slope);
}

/// Closes a bracket around a root to `finest` by parabolas (D. E. Muller, 1956): a gap in free fall is one. Where
/// they do not halve the bracket in three iterations, it is bisected.
template <class Gap>
void closeBracket(const Gap& gap, Bracket& bracket, double finest = kRootTolerance) {
  double third = 0, gapThird = 0, widthBefore = INFINITY;
  for (int i = 0; i < kMaxCuts && bracket.after - bracket.before > finest; ++i) {
    const double width = bracket.after - bracket.before;
    double estimate = bracket.before + width * bracket.gapBefore / (bracket.gapBefore - bracket.gapAfter);
    if (i > 0) estimate = rootOfParabola(bracket, third, gapThird);
    if (i % 3 == 2) {
      if (width > widthBefore / 2) estimate = bracket.before + width / 2;
      widthBefore = width;
    }
    // Half the resolution to the inside, so that both ends come to the crossing.
    if (!(estimate > bracket.before + 0.5 * finest)) estimate = bracket.before + 0.5 * finest;
    if (!(estimate < bracket.after - 0.5 * finest)) estimate = bracket.after - 0.5 * finest;
    const double found = gap(estimate);
    double& end = found > 0 ? bracket.before : bracket.after;
    double& gapEnd = found > 0 ? bracket.gapBefore : bracket.gapAfter;
    third = end, gapThird = gapEnd;
    end = estimate, gapEnd = found;
  }
}

/// First root of `gap(fraction)` between the ends, where gapBefore > 0. An interval in which the gap
/// stays open, by its bounds or because `isOpen(ends)` knows, is passed over; else it is halved, the earlier half
/// first. Where the ends differ in sign a root is found at once, and what comes before it is searched like the
/// rest.
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
  const double middle = ends.before + length / 2, gapMiddle = gap(middle);
  if (const auto crossing = firstRoot(gap, bounds, isOpen, {ends.before, ends.gapBefore, middle, gapMiddle}))
    return crossing;
  if (gapMiddle <= 0) return middle;
  return firstRoot(gap, bounds, isOpen, {middle, gapMiddle, ends.after, ends.gapAfter});
}

/// The same where nothing but the bounds is known.
template <class Gap>
std::optional<double> firstRoot(const Gap& gap, const GapBounds& bounds, const Bracket& ends) {
  return firstRoot(
      gap, bounds, [](const Bracket&) { return false; }, ends);
}

}  // namespace cradle
