#include "constraints/minimum_norm.h"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "dynamics/free_bodies.h"

namespace cradle {
namespace {

MatrixX randomMatrix(Random& random, int rows, int columns) {
  MatrixX matrix(rows, columns);
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < rows; ++row) matrix(row, column) = random.between(-1, 1);
  return matrix;
}

struct Problem {
  MatrixX symmetric, coupled;  // S and S + C
};
/// Rows of a matrix of that rank; C answers in the span of the same rows.
Problem problemOf(Random& random, int size, int rank, double coupling) {
  const MatrixX rows = randomMatrix(random, size, rank);
  const MatrixX response = rows.transpose() + coupling * randomMatrix(random, rank, size);
  return {rows * rows.transpose(), rows * response};
}

VectorX solved(const Problem& problem, bool isCoupled, const VectorX& rightHandSide, bool sharesLoads = false) {
  const int size = static_cast<int>(rightHandSide.size());
  MinimumNormSolver solver;
  solver.resize(size);
  for (int column = 0; column < size; ++column) {
    solver.whole(column) = problem.symmetric(column, column);
    for (int row = 0; row < size; ++row) {
      solver.symmetric(row, column) = problem.symmetric(row, column);
      solver.coupled(row, column) = problem.coupled(row, column);
    }
  }
  solver.factorize(size, isCoupled, sharesLoads);
  VectorX x = rightHandSide;
  solver.solve(x.data());
  return x;
}

// Eigen's complete orthogonal decomposition gives the same by Householder reflections. Right-hand sides are in part
// contradictions. Condition numbers here are below 1e5, so 1e-16 grows to 1e-11 of solutions of up to 1e2.
TEST(MinimumNorm, AgreesWithACompleteOrthogonalDecomposition) {
  Random random;
  for (int size = 1; size <= 13; ++size)
    for (int rank = 1; rank <= size; ++rank)
      for (const double coupling : {0.0, 0.4}) {
        const Problem problem = problemOf(random, size, rank, coupling);
        const VectorX rightHandSide = randomMatrix(random, size, 1);
        Eigen::CompleteOrthogonalDecomposition<MatrixX> oracle;
        oracle.setThreshold(1e-9);
        oracle.compute(problem.coupled);
        const VectorX expected = oracle.solve(rightHandSide), got = solved(problem, coupling > 0, rightHandSide);
        EXPECT_LT((got - expected).norm(), 1e-8 * (1 + expected.norm())) << size << " " << rank << " " << coupling;
      }
}

// Of all solutions x, the one in the span of S: x = S w, with (S + C) S w as near to b as can be.
TEST(MinimumNorm, SharesLoadsInTheSpanOfItsRows) {
  Random random;
  for (int size = 2; size <= 8; ++size)
    for (int rank = 1; rank < size; ++rank) {
      const Problem problem = problemOf(random, size, rank, 0.4);
      const VectorX rightHandSide = randomMatrix(random, size, 1);
      Eigen::CompleteOrthogonalDecomposition<MatrixX> oracle;
      oracle.setThreshold(1e-9);
      oracle.compute(problem.coupled * problem.symmetric);
      const VectorX expected = problem.symmetric * oracle.solve(rightHandSide);
      const VectorX got = solved(problem, true, rightHandSide, true);
      EXPECT_LT((got - expected).norm(), 1e-7 * (1 + expected.norm())) << size << " " << rank;
    }
}

TEST(MinimumNorm, LeavesARowWithoutAnyResponseAlone) {
  Problem problem{MatrixX::Zero(2, 2), MatrixX::Zero(2, 2)};
  problem.symmetric(0, 0) = 4;
  EXPECT_EQ(solved(problem, false, Eigen::Vector2d(2, 1)), Eigen::Vector2d(0.5, 0));
}

// Two rows that differ by 1e-8 and ask for opposite things: the least squares of both, not forces of 1e8.
TEST(MinimumNorm, DoesNotExplodeWhereRowsNearlyContradict) {
  MatrixX rows(2, 2);
  rows << 1, 0, 1, 1e-8;
  const MatrixX matrix = rows * rows.transpose();
  const VectorX x = solved({matrix, matrix}, false, Eigen::Vector2d(1, 0));
  EXPECT_NEAR(x[0] + x[1], 0.5, 1e-7);
  EXPECT_LT(x.norm(), 1);
}

}  // namespace
}  // namespace cradle
