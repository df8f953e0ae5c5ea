#include "constraints/spring_modes.h"

#include <gtest/gtest.h>

#include "constraints/contact_motion.h"

namespace cradle {
namespace {

// Power iteration ends where the quotient, whose error is the square of the mode's, grows by less than 1e-6 of it.
constexpr double kModeError = 1e-4;

SpringForce springBetween(int a, int b, double stiffness, double damping = 0) {
  return {{a, Vec3::Zero()}, {b, Vec3::Zero()}, stiffness, damping, 0.5};
}

/// Balls of these masses in a row along x, 1 m apart.
Mechanism ballsInARow(const std::vector<double>& masses) {
  Mechanism mechanism;
  for (const double mass : masses) mechanism.bodies.push_back(solidSphere(mass, 0.1));
  return mechanism;
}
VectorX rowState(std::size_t balls) {
  VectorX state = restingState(balls);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(balls); ++i)
    centerOfMass(state, i).x() = static_cast<double>(i);
  return state;
}

// Two masses on a spring: k (1/m + 1/M), and the same of the damping, at any size.
TEST(SpringModes, OfTwoMassesAreThoseOfTheReducedMass) {
  for (const double mass : {1.0, 1e-6, 1e6}) {
    Mechanism mechanism = ballsInARow({mass, 3 * mass});
    mechanism.springs = {springBetween(0, 1, 50, 0.3)};
    const SpringMode mode = stiffestMode(mechanism, rowState(2));
    EXPECT_NEAR(mode.stiffness, 50 * 4 / (3 * mass), 1e-12 / mass);
    EXPECT_NEAR(mode.damping, 0.3 * 4 / (3 * mass), 1e-14 / mass);
    EXPECT_EQ(mode.spring, 0u);
  }
}

// n equal masses in a row: 2 k/m (1 - cos(pi j / n)), largest for j = n - 1 (a chain with free ends).
TEST(SpringModes, OfAChainIsTheLargestEigenvalue) {
  for (const std::size_t balls : {3u, 4u, 6u}) {
    Mechanism mechanism = ballsInARow(std::vector<double>(balls, 2));
    for (int i = 0; i + 1 < static_cast<int>(balls); ++i) mechanism.springs.push_back(springBetween(i, i + 1, 80));
    const double n = static_cast<double>(balls), expected = 2 * 80 / 2.0 * (1 - std::cos(M_PI * (n - 1) / n));
    const SpringMode mode = stiffestMode(mechanism, rowState(balls));
    EXPECT_NEAR(mode.stiffness, expected, kModeError * expected);
    EXPECT_LE(mode.stiffness, expected * (1 + 1e-12));  // a quotient is never larger
    EXPECT_EQ(mode.damping, 0);
  }
}

// Springs that act together on one mass add up; the largest share is the stiffest's. Damping has a mode of its own.
TEST(SpringModes, AddUpAndTellTheSpringWithTheLargestPart) {
  Mechanism mechanism = ballsInARow({2, 1, 5});
  mechanism.springs = {springBetween(0, kFixed, 30, 4), springBetween(0, kFixed, 70), springBetween(1, 2, 1, 90)};
  VectorX state = rowState(3);
  centerOfMass(state, 0) = Vec3(0, 3, 0);
  const SpringMode stiffest = stiffestMode(mechanism, state), damped = mostDampedMode(mechanism, state);
  EXPECT_NEAR(stiffest.stiffness, 50, 1e-12);
  EXPECT_NEAR(stiffest.damping, 2, 1e-13);
  EXPECT_EQ(stiffest.spring, 1u);
  EXPECT_NEAR(damped.damping, 90 * 1.2, 1e-11);
  EXPECT_NEAR(damped.stiffness, 1.2, 1e-13);
  EXPECT_EQ(damped.spring, 2u);
}

// On a lever the body's turning counts, 1/m + (r x n) I^-1 (r x n); velocities of the state do not.
TEST(SpringModes, CountTheTurningOfTheBody) {
  Mechanism mechanism;
  mechanism.bodies = {bodyOf(2, Vec3(0.5, 0.6, 0.7).asDiagonal())};
  mechanism.springs = {{{0, Vec3(0.3, 0, 0)}, {kFixed, Vec3(0.3, 4, 0)}, 100, 1, 1}};
  VectorX state = restingState(1);
  linearVelocity(state, 0) = Vec3(3, 2, 1), angularVelocity(state, 0) = Vec3(1, 5, -2);
  const SpringMode mode = stiffestMode(mechanism, state);
  EXPECT_NEAR(mode.stiffness, 100 * (0.5 + 0.09 / 0.7), 1e-11);
  EXPECT_NEAR(mode.damping, 0.5 + 0.09 / 0.7, 1e-13);
}

// A rod to the world along the spring leaves it nothing, one across it everything; one at 60 degrees cos^2 of 30.
TEST(SpringModes, AreThoseThatRodsAllow) {
  for (const double angle : {0.0, M_PI / 3, M_PI / 2}) {
    Mechanism mechanism = ballsInARow({2});
    mechanism.springs = {{{0, Vec3::Zero()}, {kFixed, Vec3(3, 0, 0)}, 40, 0.5, 1}};
    mechanism.constraints = {
        {{0, Vec3::Zero()}, {kFixed, Vec3(std::cos(angle), std::sin(angle), 0)}, RodConstraint{1}}};
    const double part = std::sin(angle) * std::sin(angle);
    EXPECT_NEAR(stiffestMode(mechanism, restingState(1)).stiffness, 20 * part, 1e-13);
    EXPECT_NEAR(mostDampedMode(mechanism, restingState(1)).damping, 0.25 * part, 1e-13);
  }
  EXPECT_EQ(stiffestMode(ballsInARow({1}), restingState(1)).stiffness, 0);  // no springs
}

}  // namespace
}  // namespace cradle
