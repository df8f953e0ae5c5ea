#pragma once

#include <algorithm>

namespace cradle {

constexpr double kTimeRounding = 1e-9;     // of a step: remainders below it are rounding
constexpr double kAtOnce = 1e-6;           // of a step: changes of several contacts, limits or motors that are one
constexpr double kRestSpeedFloor = 1e-12;  // m/s: slower is rounding
constexpr double kRopeTolerance = 1e-13;   // of the length, or of the tension that is left

// Evaluations of the equations of islands, a quarter of a millisecond and more: below, threads wait for each other for
// about as long as they share.
constexpr long kSharedEvaluations = 500;

/// s: what is nearer to `time` (s) than that is at the same time.
inline double sameTime(double time) {
  return 1e-12 * std::max(1.0, time);
}

}  // namespace cradle
