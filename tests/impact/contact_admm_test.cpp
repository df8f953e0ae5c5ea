#include "impact/contact_admm.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace cradle {
namespace {

constexpr double kProximalTerm = 0.01;

/// Iterations with factors of a dense matrix.
void iterateDense(const MatrixX& delassus, const ScaledContacts& contacts, int count, AdmmIterate& at) {
  const MatrixX shifted = delassus + (at.penalty + kProximalTerm) * MatrixX::Identity(delassus.rows(), delassus.cols());
  const Eigen::PartialPivLU<MatrixX> factor(shifted);
  const auto solve = [&](VectorX& b) { b = factor.solve(b).eval(); };
  iterateAdmm(contacts, kProximalTerm, solve, count, at);
}

// A contact that slides, one that sticks and one that is open, coupled by a full matrix: the solution is where the
// iteration stays, whatever the penalty.
TEST(Admm, StaysAtASolution) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  MatrixX rows(9, 9);
  for (double& entry : rows.reshaped()) entry = 0.4 * uniform(random);
  const MatrixX delassus = rows * rows.transpose() + 0.5 * MatrixX::Identity(9, 9);
  VectorX impulses(9), velocities(9);
  impulses << -0.24, 0.32, 1, 0.1, 0.2, 2, 0, 0, 0;
  velocities << 0.3, -0.4, 0, 0, 0, 0, 0.7, 0.1, 0.2;
  const ScaledContacts contacts{velocities - delassus * impulses, {0.4, 0.4, 0.3}};
  VectorX corrected = velocities;
  for (Eigen::Index i = 0; i < 3; ++i)
    corrected.segment<3>(3 * i) =
        correctedVelocity(velocities.segment<3>(3 * i), contacts.frictions[static_cast<std::size_t>(i)]);
  for (const double penalty : {0.05, 1.0, 8.0}) {
    AdmmIterate at{impulses, corrected, impulses, penalty};
    iterateDense(delassus, contacts, 5, at);
    EXPECT_LT((at.impulses - impulses).norm(), 1e-14);
    EXPECT_LT((at.velocities - corrected).norm(), 1e-13);
    EXPECT_LT((at.unbounded - impulses).norm(), 1e-14);
    EXPECT_LT(at.primalResidual + at.dualResidual, 1e-13);
    EXPECT_EQ(at.penalty, penalty);
  }
}

// The residuals are what the iterate misses: impulses outside the cones, and impulses that still change.
TEST(Admm, EndsAtCoulombsLawWithResidualsThatBoundTheError) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 10; ++trial) {
    MatrixX rows(12, 12);
    for (double& entry : rows.reshaped()) entry = 0.4 * uniform(random);
    const MatrixX delassus = rows * rows.transpose() + 0.5 * MatrixX::Identity(12, 12);
    ScaledContacts contacts{VectorX(12), {0, 0.3, 0.6, 0.9}};
    for (double& velocity : contacts.free) velocity = uniform(random);
    AdmmIterate at{VectorX::Zero(12), VectorX::Zero(12), VectorX::Zero(12), 2};
    const auto error = [&] {
      const VectorX u = delassus * at.impulses + contacts.free;
      double largest = 0;
      for (Eigen::Index i = 0; i < 4; ++i)
        largest = std::max(largest, coulombResidual(at.impulses.segment<3>(3 * i), u.segment<3>(3 * i),
                                                    contacts.frictions[static_cast<std::size_t>(i)])
                                        .norm());
      return largest;
    };
    iterateDense(delassus, contacts, 4, at);
    const VectorX before = at.impulses;
    iterateDense(delassus, contacts, 1, at);
    EXPECT_NEAR(at.dualResidual, at.penalty * (at.impulses - before).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_NEAR(at.primalResidual, (at.unbounded - at.impulses).cwiseAbs().maxCoeff(), 1e-15);
    // By Moreau's theorem each iteration leaves velocities in the dual cones, perpendicular to the impulses.
    for (Eigen::Index i = 0; i < 4; ++i)
      EXPECT_NEAR(at.impulses.segment<3>(3 * i).dot(at.velocities.segment<3>(3 * i)), 0, 1e-14);
    iterateDense(delassus, contacts, 600, at);
    EXPECT_LT(error(), 1e-10) << trial;
    EXPECT_LT(at.primalResidual + at.dualResidual, 1e-10) << trial;
  }
}

// Equations (3.13) of Boyd et al.: beyond a ratio of ten the penalty grows with the primal residual, which it brings
// down, and shrinks with the dual one; within bounds.
TEST(Admm, BalancesResidualsByThePenalty) {
  AdmmIterate at;
  at.penalty = 1;
  const auto balanced = [&](double primal, double dual, double least, double largest) {
    at.primalResidual = primal, at.dualResidual = dual;
    return balancedPenalty(at, least, largest);
  };
  EXPECT_EQ(balanced(9.9, 1, 0.01, 100), 1);
  EXPECT_EQ(balanced(1, 9.9, 0.01, 100), 1);
  EXPECT_EQ(balanced(10.1, 1, 0.01, 100), 4);
  EXPECT_EQ(balanced(1, 10.1, 0.01, 100), 0.25);
  EXPECT_EQ(balanced(10.1, 1, 0.01, 3), 3);
  EXPECT_EQ(balanced(1, 10.1, 0.5, 100), 0.5);
}

}  // namespace
}  // namespace cradle
