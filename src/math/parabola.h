#pragma once

#include <algorithm>
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

/// Where a smooth function first falls below zero on 0..1, by even samples of it, from 0 to 1, and the parabolas
/// through them, linearly between two places; none if it does not, or starts below zero and stays there. It may be
/// below zero for less than the way between two samples: where a parabola comes near to zero, its least is looked at
/// too, and those of so many `trials` with it.
template <class Function, std::size_t count>
std::optional<double> firstFall(const Function& valueAt, const std::array<double, count>& values, int trials) {
  // Of the values beside it: a parabola through samples 1/20 of a period apart misses the least of a cosine by less.
  constexpr double kShallow = 0.05;
  const auto fallBetween = [](const Sample& before, const Sample& after) {
    return after.at - after.value * (after.at - before.at) / (after.value - before.value);
  };
  const auto sampleAt = [&](std::size_t i) { return Sample{static_cast<double>(i) / (count - 1), values[i]}; };
  for (std::size_t i = 1; i < count; ++i) {
    const Sample before = sampleAt(i - 1), after = sampleAt(i);
    if (before.value > 0 && after.value < 0) return fallBetween(before, after);
    if (i == 1) continue;
    std::array<Sample, 3> around{sampleAt(i - 2), before, after};
    for (int trial = 0; trial < trials; ++trial) {
      const auto& [a, b, c] = around;
      if (!(a.value > 0 && b.value > 0 && c.value > 0)) break;
      std::optional<Sample> least = leastOf(around);
      if (!least) least = a.value < c.value ? Sample{(a.at + b.at) / 2, a.value} : Sample{(b.at + c.at) / 2, c.value};
      if (least->value > kShallow * std::max(a.value, c.value) || least->at == b.at) break;
      const Sample found{least->at, valueAt(least->at)};
      if (found.value < 0) return fallBetween(found.at < b.at ? a : b, found);
      around = found.at < b.at ? std::array{a, found, b} : std::array{b, found, c};
    }
  }
  return std::nullopt;
}

}  // namespace cradle
