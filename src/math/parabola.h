#pragma once

#include <array>
#include <optional>

namespace cradle {

/// A sample of a function of one number.
struct Sample {
  double at, value;
};

/// Where the parabola through three samples, in ascending order, is least, and what it is there; none if that is not
/// between the outer ones.
inline std::optional<Sample> leastOf(const std::array<Sample, 3>& samples) {
  const auto& [a, b, c] = samples;
  const double first = (b.value - a.value) / (b.at - a.at), second = (c.value - b.value) / (c.at - b.at);
  const double bend = (second - first) / (c.at - a.at);
  if (!(bend > 0)) return std::nullopt;
  const double at = (a.at + b.at) / 2 - first / (2 * bend);
  if (!(at > a.at && at < c.at)) return std::nullopt;
  return Sample{at, a.value + (at - a.at) * (first + bend * (at - b.at))};
}

}  // namespace cradle
