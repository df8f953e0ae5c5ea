#pragma once

#include <algorithm>
#include <cmath>

namespace cradle {

/// The tolerances of hard spheres. These move in closed form, so that only rounding is tolerated, at any accuracy.
struct SphereTolerances {
  double gravity = 0;  // g, m/s^2

  // Nearer is touching. Places are known to rounding, and of spheres of different masses the order of collisions
  // counts. r is the smaller radius.
  static constexpr double kSphereTouchRatio = 1e-11;               // of r
  static double touch(double r) { return kSphereTouchRatio * r; }  // m

  // What touches and closes more slowly does so by rounding. `speeds` bounds those of the centres, m/s.
  static constexpr double kSlowRatio = 1e-14;
  static double minClosingSpeed(double speeds) { return kSlowRatio * speeds; }  // m/s

  // A sphere of radius r and that speed (m/s) that meets an obstacle more slowly neither bounces nor leaves: a bounce
  // would be 5e-15 r high, or is rounding.
  static constexpr double kSphereRestRatio = 1e-7;      // of sqrt(g r)
  static constexpr double kSphereRestRounding = 1e-13;  // of the speed
  double maxRestSpeed(double r, double speed) const {   // m/s
    return std::max(kSphereRestRatio * std::sqrt(gravity * r), kSphereRestRounding * speed);
  }

  // What presses less carries nothing.
  static constexpr double kLoadedRatio = 1e-9;                             // of g
  double minLoadedAcceleration() const { return kLoadedRatio * gravity; }  // m/s^2
};

}  // namespace cradle
