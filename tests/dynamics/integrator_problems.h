#pragma once

#include <algorithm>
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

/// The state after `steps` equal steps from time 0.
inline VectorX stateAfter(Integrator integrate, const RightHandSide& rightHandSide, const VectorX& start,
                          double duration, int steps) {
  Step step;
  VectorX state = start;
  const double timeStep = duration / steps;
  for (int i = 0; i < steps; ++i) {
    integrate(rightHandSide, state, i * timeStep, timeStep, step);
    state = step.state;
  }
  return state;
}

/// log2 of the ratio of two errors: the order, if the second belongs to half the step.
inline double orderOf(double error, double errorOfHalf) {
  return std::log2(error / errorOfHalf);
}

/// A step of the planet, ready to be interpolated.
inline Step keplerStep(Integrator integrate, double time, double timeStep) {
  Step step;
  integrate(kepler(), keplerAt(time), time, timeStep, step);
  prepareInterpolant(kepler(), step);
  return step;
}

/// The largest error at 19 places inside a step of the planet.
inline double interpolationError(Integrator integrate, double timeStep) {
  const double time = 0.4;
  const Step step = keplerStep(integrate, time, timeStep);
  VectorX state;
  double most = 0;
  for (int i = 1; i < 20; ++i) {
    interpolate(step, i / 20.0, state);
    most = std::max(most, (state - keplerAt(time + i / 20.0 * timeStep)).norm());
  }
  return most;
}

/// A step of y' = 1e300 y^2 out of the finite numbers, beside a component that stays where it is.
inline Step stepOutOfFiniteNumbers(Integrator integrate) {
  const RightHandSide explosion{[](double, const VectorX& state, VectorX& rate) {
                                  rate[0] = 0;
                                  rate[1] = 1e300 * state[1] * state[1];
                                },
                                nullptr, 1};
  Step step;
  integrate(explosion, Eigen::Vector2d(1, 1), 0, 1, step);
  return step;
}

}  // namespace cradle
