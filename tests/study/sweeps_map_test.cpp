#include "study/stability/sweeps_map.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

constexpr double kPi = 3.14159265358979324;

double factorOf(const StopProblem& problem) {
  return convergenceFactor(
      GaussSeidel(problem.rows, problem.kind, problem.assembly.mechanism.bodies, problem.state).matrix());
}

/// Sweeps go as 1 / log(factor): both to 1 %.
void expectSweepsLike(double measured, double expected) {
  EXPECT_NEAR(std::log(measured) / std::log(expected), 1, 0.01) << expected;
}

TEST(Sweeps, LeaveAHeavyBodyOnALightOneItsShareOfTheSpeed) {
  for (const double mass : {1.0, 9.0, 99.0, 999.0}) {
    expectSweepsLike(countSweeps(stackToStop(2, mass)).factor, mass / (mass + 1));
    expectSweepsLike(countSweeps(chainToStop(2, mass)).factor, mass / (mass + 1));
  }
}

// J M^-1 J^T of n equal balls is 1/m times the matrix 2 on the diagonal, 1 at the ground, -1 beside it; scaled to 1 on
// the diagonal, Jacobi's eigenvalues are cos((2 k - 1) pi / (2 n)) (Chebyshev's polynomial of degree n).
TEST(Sweeps, OfEqualBallsConvergeAsChebyshevsRootsSay) {
  for (const int balls : {2, 5, 10}) {
    const double expected = std::pow(std::cos(kPi / (2 * balls)), 2);
    EXPECT_NEAR(factorOf(stackToStop(balls, 1)), expected, 1e-13);
    expectSweepsLike(countSweeps(stackToStop(balls, 1)).factor, expected);
    expectSweepsLike(countSweeps(chainToStop(balls, 1)).factor, expected);
  }
}

TEST(Sweeps, OfATallStackConvergeAsTheirLargestEigenvalue) {
  for (const double mass : {10.0, 100.0}) {
    const StopProblem stack = stackToStop(10, mass), chain = chainToStop(10, mass);
    expectSweepsLike(countSweeps(stack).factor, factorOf(stack));
    expectSweepsLike(countSweeps(chain).factor, factorOf(chain));
  }
}

// The speed of the fall is 0.16 m/s; what is left is rounding, times the ratio of the masses.
TEST(Sweeps, AreNotWhatOurSolversNeedAtAnyMass) {
  for (const double mass : {1.0, 1000.0, 10000.0}) {
    const DirectSolution rods = solveDirectly(chainToStop(20, mass));
    EXPECT_EQ(rods.solves, 1);
    EXPECT_LT(rods.speedLeft, 1e-15 * (1 + mass));
    EXPECT_LT(solveDirectly(stackToStop(20, mass)).speedLeft, 1e-12);
  }
}

TEST(Sweeps, OfRodsThatOnlyPushDoNotHoldAChain) {
  const StopProblem chain = chainToStop(3, 1);
  GaussSeidel solver(chain.rows, RowKind::pushes, chain.assembly.mechanism.bodies, chain.state);
  for (int i = 0; i < 50; ++i) solver.sweep();
  EXPECT_NEAR(linearVelocity(solver.state(), 2).norm(), 9.81 / 60, 1e-12);
}

}  // namespace
}  // namespace cradle
