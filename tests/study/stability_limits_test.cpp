// Borders of stability: of theory against the literature, of runs against theory.

#include <gmock/gmock.h>

#include <cmath>

#include "constraints/invariants.h"
#include "study/stability/hung_box.h"
#include "study/stability/island_steps.h"
#include "study/stability/oscillator.h"
#include "study/stability/stability_region.h"

namespace cradle {
namespace {

TEST(StabilityRegion, LimitsAreThoseOfTheLiterature) {
  EXPECT_EQ(oscillatorLimit(fixedStepMethod("explicitEuler"), 0), 0);
  EXPECT_NEAR(oscillatorLimit(fixedStepMethod("semiImplicitEuler"), 0), 2, 1e-6);
  EXPECT_NEAR(oscillatorLimit(fixedStepMethod("rk4"), 0), 2 * std::sqrt(2), 1e-6);
  EXPECT_NEAR(oscillatorLimit(fixedStepMethod("dop853FixedStep"), 0), 5.96, 0.005);
  EXPECT_NEAR(decayLimit(fixedStepMethod("explicitEuler")), 2, 1e-6);
  EXPECT_NEAR(decayLimit(fixedStepMethod("rk4")), 2.785293563, 1e-6);
}

TEST(StabilityRegion, DampingShiftsTheLimitsOfBothEulers) {
  // |1 + z|^2 = 1 - 2 zeta z + z^2 below critical damping; of semi-implicit Euler trace = -(1 + determinant).
  for (const double ratio : {0.1, 0.5, 0.9})
    EXPECT_NEAR(oscillatorLimit(fixedStepMethod("explicitEuler"), ratio), 2 * ratio, 1e-6);
  for (const double ratio : {0.1, 0.5, 2.0})
    EXPECT_NEAR(oscillatorLimit(fixedStepMethod("semiImplicitEuler"), ratio),
                2 * (std::sqrt(1 + ratio * ratio) - ratio), 1e-6);
}

TEST(StabilityRegion, ThePolynomialOfDop853IsThatOfOrderEight) {
  const std::vector<double>& polynomial = fixedStepMethod("dop853FixedStep").stabilityPolynomial;
  ASSERT_EQ(polynomial.size(), 13U);
  double factorial = 1;
  for (std::size_t i = 0; i <= 8; factorial *= static_cast<double>(++i))
    EXPECT_NEAR(polynomial[i] * factorial, 1, 1e-9) << i;  // terms of some 1e2 cancel, eight times over
  EXPECT_GT(std::abs(polynomial[9] * factorial - 1), 1e-3);
}

TEST(StabilityRegion, APolynomialIsWhatAStepDoes) {
  // y' = lambda y as a system of two real equations.
  const std::complex<double> lambda(-1.3, 2.1);
  const RightHandSide equation{[&](double, const VectorX& state, VectorX& rate) {
                                 rate.resize(2);
                                 rate << lambda.real() * state[0] - lambda.imag() * state[1],
                                     lambda.imag() * state[0] + lambda.real() * state[1];
                               },
                               [](const VectorX&, VectorX&) {}, 0};
  for (const char* name : {"explicitEuler", "rk4", "dop853FixedStep"}) {
    Step step;
    fixedStepMethod(name).integrate(equation, Eigen::Vector2d(1, 0), 0, 0.9, step);
    EXPECT_NEAR(growthOf(fixedStepMethod(name), 0.9 * lambda), step.state.norm(), 1e-13) << name;
  }
}

/// Runs of 1000 steps show a growth of 1.001 a step; one per cent beyond a limit it is 1.01 and more.
void expectMeasuredLimit(const Oscillator& oscillator, const char* name) {
  const FixedStepMethod& method = fixedStepMethod(name);
  const double limit = oscillatorLimit(method, oscillator.dampingRatio) / oscillator.omega;
  EXPECT_NEAR(measuredOscillatorLimit(oscillator, method), limit, 0.01 * limit) << name;
}

TEST(MeasuredLimit, OfASpringWithoutDampingIsThatOfTheory) {
  for (const char* name : {"semiImplicitEuler", "rk4", "dop853FixedStep"}) expectMeasuredLimit({10, 0}, name);
  EXPECT_EQ(measuredOscillatorLimit({10, 0}, fixedStepMethod("explicitEuler")), 0);
}

TEST(MeasuredLimit, OfASpringWithDampingIsThatOfTheory) {
  for (const FixedStepMethod& method : fixedStepMethods())
    for (const double ratio : {0.25, 1.5}) expectMeasuredLimit({10, ratio}, method.name.c_str());
}

TEST(MeasuredLimit, OfAStiffSpringOnTheCornerOfABoxIsThatOfTheMassThatItMoves) {
  // 1 / m + (r x n)^T I^-1 (r x n) = 0.5 + 0.01 / 0.0666667 + 0.04 / 0.0866667. The spring trembles with (m g)^2 / k,
  // and a run is stopped where it has what the fall can give, a hundred thousand times that: in 600 steps, by a growth
  // of 1.01 a step. By then, after 0.05 s, the swing of the box has changed the mass by less than a per cent.
  const double stiffness = 1e9, omega = std::sqrt(stiffness * (0.5 + 0.15 + 0.04 / (0.26 / 3)));
  Scene scene = hungBox(stiffness, 0);
  EXPECT_NEAR(boxOmega(scene), omega, 1e-9 * omega);
  for (const char* name : {"semiImplicitEuler", "rk4", "dop853FixedStep"}) {
    const FixedStepMethod& method = fixedStepMethod(name);
    const double limit = oscillatorLimit(method, 0) / omega;
    const auto isStable = [&](double timeStep) { return isStableFor(scene, method, timeStep, 600); };
    EXPECT_NEAR(measuredLimit(isStable, 0.7 / omega), limit, 0.01 * limit) << name;
  }
}

/// Kutta's method with its last stage at the middle of the step: R(z) = 1 + z + 5/12 z^2 + z^3 / 8 + z^4 / 48.
void brokenRk4(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  beginStep(rightHandSide, state, time, timeStep, step);
  VectorX k = step.startDerivative;
  step.state = state + (timeStep / 6) * k;
  for (const double weight : {1.0 / 3, 1.0 / 3, 1.0 / 6}) {
    step.stage = state + (timeStep / 2) * k;
    rightHandSide.derivative(time + timeStep / 2, step.stage, k);
    step.state += weight * timeStep * k;
  }
}

/// The longest step after a thousand of which the energy is less than twice what it was.
double measuredLimitOf(Integrator integrate, double dampingRatio) {
  const Scene scene = oscillatorScene({1, dampingRatio});
  return measuredLimit(
      [&](double timeStep) {
        IslandSteps steps(scene, integrate, timeStep, false);
        for (int i = 0; i < 1000; ++i) steps.advance();
        const Invariants sums = invariantsOf(steps.assembly().mechanism, steps.state());
        return sums.kinetic + sums.potential < kOscillatorAmplitude * kOscillatorAmplitude;
      },
      0.2);
}

TEST(MeasuredLimit, OfABrokenMethodIsItsOwn) {
  const FixedStepMethod broken{"", "", brokenRk4, {1, 1, 5.0 / 12, 1.0 / 8, 1.0 / 48}};
  const double limit = oscillatorLimit(broken, 0.5), right = oscillatorLimit(fixedStepMethod("rk4"), 0.5);
  EXPECT_GT(std::abs(limit - right), 0.05 * right);
  EXPECT_NEAR(measuredLimitOf(brokenRk4, 0.5), limit, 0.01 * limit);
  EXPECT_NEAR(measuredLimitOf(fixedStepMethod("rk4").integrate, 0.5), right, 0.01 * right);
  EXPECT_EQ(oscillatorLimit(broken, 0), 0);
  EXPECT_EQ(measuredLimitOf(brokenRk4, 0), 0);
}

TEST(OscillatorStability, IsUnstableInaccurateOrStableByTheStep) {
  const FixedStepMethod& method = fixedStepMethod("semiImplicitEuler");
  EXPECT_EQ(oscillatorStability({10, 0}, method, 0.21), Stability::unstable);
  EXPECT_EQ(oscillatorStability({10, 0}, method, 0.1), Stability::inaccurate);
  EXPECT_EQ(oscillatorStability({10, 0}, method, 0.005), Stability::stable);
}

}  // namespace
}  // namespace cradle
