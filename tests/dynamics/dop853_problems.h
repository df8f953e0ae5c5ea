#pragma once

#include <cmath>
#include <numbers>

#include "dynamics/integrators/step.h"

// Problems with known solutions, for tests of integrators.

namespace cradle {

/// x'' = -omega^2 x as (x, v).
inline RightHandSide oscillator(double omega) {
  return {[=](double, const VectorX& state, VectorX& rate) {
            rate[0] = state[1];
            rate[1] = -omega * omega * state[0];
          },
          nullptr, 1};
}

inline VectorX oscillatorAt(double omega, double time) {
  return Eigen::Vector2d(std::cos(omega * time), -omega * std::sin(omega * time));
}

constexpr double kEccentricity = 0.3;

/// A planet on an ellipse of half axis 1 about a sun of unit gravity, as (x, y, vx, vy): goes round in 2 pi.
inline RightHandSide kepler() {
  return {[](double, const VectorX& state, VectorX& rate) {
            const double square = state[0] * state[0] + state[1] * state[1];
            rate.head<2>() = state.tail<2>();
            rate.tail<2>() = -state.head<2>() / (square * std::sqrt(square));
          },
          nullptr, 2};
}

/// Its place, nearest to the sun at time 0, by Kepler's equation: time = E - e sin(E).
inline VectorX keplerAt(double time) {
  const double mean = std::remainder(time, 2 * std::numbers::pi), e = kEccentricity, axis = std::sqrt(1 - e * e);
  double anomaly = mean;
  for (int i = 0; i < 20; ++i) anomaly -= (anomaly - e * std::sin(anomaly) - mean) / (1 - e * std::cos(anomaly));
  const double c = std::cos(anomaly), s = std::sin(anomaly), speed = 1 / (1 - e * c);
  return Eigen::Vector4d(c - e, axis * s, -s * speed, axis * c * speed);
}

}  // namespace cradle
