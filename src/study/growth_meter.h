#pragma once

#include <optional>

namespace cradle {

/// A scene that makes small differences large.
struct Divergence {
  double rate = 0;                        // 1/s: a small difference grows by e in 1 / rate
  std::optional<double> meaninglessFrom;  // s: by then the small difference is seen in the second digit
};

/// Follows how a small difference grows: the rate at which neighbouring motions part is the largest Lyapunov exponent,
/// as far as one run shows it (Benettin et al., Meccanica 15, 1980).
class GrowthMeter {
 public:
  /// `disturbance`: m/s and rad/s that the start differs by.
  explicit GrowthMeter(double disturbance) : disturbance_(disturbance) {}

  /// To be called in the order of time (s).
  void take(double time, double difference);

  double largest() const { return largest_; }

  /// Whether the difference has grown faster than time, and to the second digit.
  bool isMeaningless() const { return isFast_ && meaninglessFrom_; }
  std::optional<Divergence> divergence() const;

 private:
  struct Point {
    double time = 0, difference = 0;  // s; 0: not yet
  };
  double disturbance_, largest_ = 0;
  bool isFast_ = false;
  Point first_, last_;  // between which growth is measured
  std::optional<double> meaninglessFrom_;
};

constexpr double kSecondDigit = 1e-2;

}  // namespace cradle
