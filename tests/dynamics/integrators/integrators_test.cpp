#include <gtest/gtest.h>

#include <cmath>

#include "dynamics/integrators/explicit_euler.h"
#include "dynamics/integrators/rk4.h"
#include "dynamics/integrators/semi_implicit_euler.h"

namespace cradle {
namespace {

constexpr double kAcceleration = 9.81;

/// x'' = -omega^2 x + g as (x, v): an oscillator, or free fall for omega = 0.
RightHandSide pulledOscillator(double omega, double gravity) {
  return {[=](double, const VectorX& state, VectorX& rate) {
            rate[0] = state[1];
            rate[1] = -omega * omega * state[0] + gravity;
          },
          [](const VectorX& state, VectorX& rate) { rate[0] = state[1]; }, 1};
}

VectorX run(Integrator integrate, const RightHandSide& rightHandSide, const VectorX& start, double timeStep,
            int steps) {
  Step step;
  VectorX state = start;
  for (int i = 0; i < steps; ++i) {
    integrate(rightHandSide, state, i * timeStep, timeStep, step);
    state = step.state;
  }
  return state;
}

double energy(const VectorX& state, double omega) {
  return 0.5 * state[1] * state[1] + 0.5 * omega * omega * state[0] * state[0];
}

// n steps of semi-implicit Euler from rest: v_n = g n h, x_n = g h^2 n (n + 1) / 2 = g t^2 / 2 + g h t / 2.
TEST(SemiImplicitEuler, FreeFallErrorIsHalfGravityTimesStepTimesTime) {
  const double timeStep = 0.01, time = 1;
  const VectorX end = run(semiImplicitEuler, pulledOscillator(0, kAcceleration), Eigen::Vector2d(0, 0), timeStep, 100);
  // 100 additions of numbers below 10: rounding below 100 * 1e-15.
  EXPECT_NEAR(end[0], kAcceleration * time * time / 2 + kAcceleration * timeStep * time / 2, 1e-13);
  EXPECT_NEAR(end[1], kAcceleration * time, 1e-13);
}

// The same sum with the old velocity: x_n = g h^2 n (n - 1) / 2.
TEST(ExplicitEuler, FreeFallErrorIsMinusHalfGravityTimesStepTimesTime) {
  const double timeStep = 0.01, time = 1;
  const VectorX end = run(explicitEuler, pulledOscillator(0, kAcceleration), Eigen::Vector2d(0, 0), timeStep, 100);
  EXPECT_NEAR(end[0], kAcceleration * time * time / 2 - kAcceleration * timeStep * time / 2, 1e-13);
}

TEST(ExplicitEuler, OscillatorEnergyGrowsByOnePlusStepTimesOmegaSquaredAStep) {
  const double omega = 3, timeStep = 0.01;
  const VectorX end = run(explicitEuler, pulledOscillator(omega, 0), Eigen::Vector2d(1, 0), timeStep, 200);
  const double growth = std::pow(1 + std::pow(timeStep * omega, 2), 200);
  EXPECT_NEAR(energy(end, omega) / energy(Eigen::Vector2d(1, 0), omega), growth, growth * 1e-12);
}

// x and v map by a matrix of determinant 1 that keeps v^2 + omega^2 x^2 - h omega^2 x v (E. Hairer, C. Lubich, G.
// Wanner, "Geometric Numerical Integration", I.1).
TEST(SemiImplicitEuler, OscillatorKeepsItsModifiedEnergy) {
  const double omega = 3, timeStep = 0.1;
  const auto modified = [=](const VectorX& s) { return 2 * energy(s, omega) - timeStep * omega * omega * s[0] * s[1]; };
  const Eigen::Vector2d start(1, 0.3);
  const VectorX end = run(semiImplicitEuler, pulledOscillator(omega, 0), start, timeStep, 1000);
  EXPECT_NEAR(modified(end), modified(start), 1e-11);
}

TEST(SemiImplicitEuler, OscillatorIsStableUpToStepTimesOmegaTwo) {
  const auto farthest = [](double omega) {
    return run(semiImplicitEuler, pulledOscillator(omega, 0), Eigen::Vector2d(1, 0), 1, 1000).cwiseAbs().maxCoeff();
  };
  EXPECT_LT(farthest(1.99), 1e3);
  EXPECT_GT(farthest(2.01), 1e6);
}

// With A = (0, 1; -omega^2, 0) the fourth stage stands at (1 + h A + (h A)^2 / 2 + (h A)^3 / 4) y, the end at the
// Taylor polynomial of degree 4: their rates, times h / 6, differ by ((h A)^4 / 72 - (h A)^5 / 144) y. For y = (1, 0)
// that is z^4 / 72 in x and omega z^5 / 144 in v, z = h omega. What it estimates is z^5 / 120 omega in v, and smaller.
TEST(RungeKutta4, ErrorEstimateMatchesTheClosedFormAndBoundsTheError) {
  const double omega = 3;
  for (const double timeStep : {0.1, 0.01}) {
    const double z = timeStep * omega;
    Step step;
    rk4(pulledOscillator(omega, 0), Eigen::Vector2d(1, 0), 0, timeStep, step);
    prepareInterpolant(pulledOscillator(omega, 0), step);
    const double inX = std::pow(z, 4) / 72 / (1 + std::abs(step.state[0]));
    const double inV = omega * std::pow(z, 5) / 144 / (1 + std::abs(step.state[1]));
    EXPECT_NEAR(rk4Error(step, step.state.size()), std::max(inX, inV), 1e-16);
    const Eigen::Vector2d exact(std::cos(z), -omega * std::sin(z));
    EXPECT_LT((step.state - exact).cwiseAbs().maxCoeff() / (1 + exact.norm()), rk4Error(step, step.state.size()));
    step.work[0] = NAN;  // a rate that is not finite is no small error
    EXPECT_FALSE(rk4Error(step, step.state.size()) <= 1);
  }
}

// One step multiplies (x, v) by the Taylor polynomial of degree 4 of exp(h A): energy grows by 1 - z^6/72 + z^8/576, z
// = h omega, which is below 1 up to z = 2 sqrt(2).
TEST(Rk4, OscillatorEnergyChangesAsItsTaylorPolynomialSays) {
  for (const double z : {0.5, 2.8, 2.9}) {
    const VectorX end = run(rk4, pulledOscillator(z, 0), Eigen::Vector2d(1, 0), 1, 10);
    const double expected = std::pow(1 - std::pow(z, 6) / 72 + std::pow(z, 8) / 576, 10);
    EXPECT_NEAR(energy(end, z) / energy(Eigen::Vector2d(1, 0), z), expected, expected * 1e-12) << z;
  }
}

TEST(Rk4, IsExactForPolynomialsOfDegreeFour) {
  const RightHandSide quartic{[](double t, const VectorX&, VectorX& rate) { rate[0] = 5 * t * t * t - 3 * t * t + 1; },
                              nullptr, 0};
  const VectorX end = run(rk4, quartic, VectorX::Zero(1), 2, 1);
  EXPECT_NEAR(end[0], 5 * 16 / 4.0 - 8 + 2, 1e-14 * 20);
}

}  // namespace
}  // namespace cradle
