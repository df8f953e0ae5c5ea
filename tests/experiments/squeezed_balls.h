#pragma once

#include <array>
#include <optional>

namespace cradle {

/// A ball over a floor and another one over it, centres above each other, without friction.
struct SqueezedBalls {
  std::array<double, 2> masses{}, gaps{}, velocities{};  // kg; m, below each; m/s, upwards
  double restitution = 0, gravity = 0;                   // gravity downwards, m/s^2
};

/// How far (m, upwards) both have gone after `time` (s), impact by impact, with the gaps as variables of their own.
/// Impacts that come ever faster, up to 10^-200 s, end with both at rest. None if the lower ball comes to rest before
/// the upper one reaches it: what the next impact does is then a matter of laws for simultaneous impacts.
std::optional<std::array<double, 2>> waysOf(SqueezedBalls balls, double time);

}  // namespace cradle
