#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "impact/linear_complementarity.h"

namespace cradle {
namespace {

MatrixX randomMatrix(int rows, int columns, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  return MatrixX::NullaryExpr(rows, columns, [&](Eigen::Index, Eigen::Index) { return number(random); });
}

/// The largest violation of 0 <= lambda perp A lambda + b >= 0, as a part of the largest sum of a row's terms.
double violation(const MatrixX& a, const VectorX& b, const VectorX& lambda) {
  const VectorX slack = a * lambda + b;
  const double terms = (a.cwiseAbs() * lambda.cwiseAbs() + b.cwiseAbs()).maxCoeff();
  double worst = std::max(0.0, -lambda.minCoeff() * a.diagonal().maxCoeff());
  for (Eigen::Index i = 0; i < b.size(); ++i)
    worst = std::max(worst, lambda[i] > 0 ? std::abs(slack[i]) : std::max(0.0, -slack[i]));
  return worst / terms;
}

// A Cholesky solution of n rows is off by some n eps of the terms times the growth of rounding in the rows that do not
// push: 50 x 2e-16 x 100.
constexpr double kPivotRounding = 1e-12;

TEST(LinearComplementarity, OfOneRowPushesOrNot) {
  const MatrixX a = MatrixX::Constant(1, 1, 4);
  EXPECT_EQ(solveLinearComplementarity(a, VectorX::Constant(1, -2))[0], 0.5);
  EXPECT_EQ(solveLinearComplementarity(a, VectorX::Constant(1, 2))[0], 0);
  EXPECT_EQ(solveLinearComplementarity(a, VectorX::Zero(1))[0], 0);
}

// A = (2 -1; -1 2): both push for b = (-3, 0): lambda = (2, 1). For b = (-2, 5) the first alone: (1, 0), slack (0, 4).
TEST(LinearComplementarity, OfTwoRowsMatchesClosedForms) {
  const MatrixX a = (MatrixX(2, 2) << 2, -1, -1, 2).finished();
  EXPECT_LT((solveLinearComplementarity(a, Eigen::Vector2d(-3, 0)) - Eigen::Vector2d(2, 1)).norm(), 1e-15);
  EXPECT_LT((solveLinearComplementarity(a, Eigen::Vector2d(-2, 5)) - Eigen::Vector2d(1, 0)).norm(), 1e-15);
}

TEST(LinearComplementarity, HoldsToRoundingForRandomDefiniteMatrices) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const int size = 1 + trial % 50;
    const MatrixX root = randomMatrix(size, size + 5, random);
    const MatrixX a = root * root.transpose();
    const VectorX b = randomMatrix(size, 1, random);
    EXPECT_LT(violation(a, b, solveLinearComplementarity(a, b)), kPivotRounding) << trial;
  }
}

// As redundant contacts: A = J J^T with more rows than columns and copies of rows, b = J v, so that u = -v solves
// J (u + v) = 0 >= 0: there is a solution. A lambda does not depend on the order of the rows.
TEST(LinearComplementarity, HoldsToRoundingForSingularMatricesAndAnyOrderOfRows) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 500; ++trial) {
    const int size = 2 + trial % 49, rank = 1 + trial % 7;
    MatrixX rows = randomMatrix(size, rank, random);
    rows.row(size - 1) = rows.row(0);
    const MatrixX a = rows * rows.transpose();
    const VectorX b = rows * randomMatrix(rank, 1, random);
    const VectorX lambda = solveLinearComplementarity(a, b);
    EXPECT_LT(violation(a, b, lambda), kPivotRounding) << trial;
    const VectorX reversed = solveLinearComplementarity(a.reverse(), b.reverse());
    EXPECT_LT((a * (lambda - reversed.reverse())).norm(), kPivotRounding * size * b.norm()) << trial;
  }
}

// Masses from 1 g to 1 t in a row of touching balls: A is tridiagonal, with elements that differ by 1e6.
TEST(LinearComplementarity, HoldsToRoundingForHeavyOnLight) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(-3, 3);
  for (int trial = 0; trial < 200; ++trial) {
    const int size = 2 + trial % 20;
    MatrixX rows = MatrixX::Zero(size, size + 1);
    VectorX inverseMasses(size + 1);
    for (double& inverseMass : inverseMasses) inverseMass = std::pow(10, exponent(random));
    for (int i = 0; i < size; ++i) rows(i, i) = -1, rows(i, i + 1) = 1;
    const MatrixX a = rows * inverseMasses.asDiagonal() * rows.transpose();
    const VectorX b = rows * randomMatrix(size + 1, 1, random);
    EXPECT_LT(violation(a, b, solveLinearComplementarity(a, b)), kPivotRounding) << trial;
  }
}

// Between two walls that rounding lets close by 1e-17: no push keeps both open.
TEST(LinearComplementarity, LeavesARowThatNothingSatisfies) {
  const MatrixX a = (MatrixX(2, 2) << 1, -1, -1, 1).finished();
  const VectorX lambda = solveLinearComplementarity(a, Eigen::Vector2d(-1, 1 - 1e-9));
  EXPECT_NEAR(lambda[0] - lambda[1], 1, 1e-8);
  EXPECT_EQ(solveLinearComplementarity(MatrixX::Zero(1, 1), VectorX::Constant(1, -1))[0], 0);
}

// Rows that hold each other through ties: what is left of them is the rounding of far larger numbers. A set of pushing
// rows may come back then; a diagonal larger by 1e-7 at the most ends that, and the solution is off by as much.
TEST(LinearComplementarity, ComesToAnEndWhereRoundingDecides) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 3000; ++trial) {
    const int size = 4 + trial % 11, rank = 1 + trial % 4;
    const MatrixX rows = randomMatrix(size, rank, random), noise = 1e-12 * randomMatrix(size, size, random);
    const MatrixX a = rows * rows.transpose() + noise + noise.transpose();
    const VectorX b = rows * randomMatrix(rank, 1, random) + 1e-12 * randomMatrix(size, 1, random);
    EXPECT_LT(violation(a, b, solveLinearComplementarity(a, b)), 1e-6) << trial;
  }
}

}  // namespace
}  // namespace cradle
