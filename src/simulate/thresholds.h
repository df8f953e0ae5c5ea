#pragma once

#include <algorithm>

namespace cradle {

constexpr double kTimeRounding = 1e-9;     // of a step: remainders below it are rounding
constexpr double kRestSteps = 2;           // a rebound that ends within as many steps is not resolved
constexpr double kRestSpeedFloor = 1e-12;  // m/s: slower is rounding
constexpr double kLastBounceRatio = 1e-7;  // of sqrt(acceleration x size): bounces lower than 5e-15 of the size
constexpr double kRopeTolerance = 1e-13;   // of the length, or of the tension that is left

/// m/s^2: what is accelerated by less comes no farther than a twentieth of the accuracy (m) in a whole run (s). But
/// rounding and the solution of `residual` (m/s^2) leave as much of accelerations as large as `largest`, too.
inline double stillAcceleration(double accuracy, double duration, double largest, double residual) {
  constexpr double kRounding = 1e-11, kMax = 1e-7, kResidualRatio = 10;
  const double seen = std::max(accuracy / (10 * duration * duration), kResidualRatio * residual);
  return std::clamp(seen, kRounding * largest, kMax * largest);
}

/// s: what is nearer to `time` (s) than that is at the same time.
inline double sameTime(double time) {
  return 1e-12 * std::max(1.0, time);
}

}  // namespace cradle
