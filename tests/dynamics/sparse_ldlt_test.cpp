#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "dynamics/sparse_ldlt.h"

namespace cradle {
namespace {

/// B B^T for a random sparse B: positive semi-definite.
MatrixX randomMatrix(int size, int columns, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  std::uniform_int_distribution<int> place(0, columns - 1);
  MatrixX b = MatrixX::Zero(size, columns);
  for (int row = 0; row < size; ++row)
    for (int i = 0; i < 3; ++i) b(row, place(random)) = number(random);
  return b * b.transpose();
}

/// Solves `matrix` x = rightHandSide with the sparse factorisation.
VectorX solveSparse(const MatrixX& matrix, const VectorX& rightHandSide) {
  const int size = static_cast<int>(matrix.rows());
  std::vector<std::pair<int, int>> places;
  std::vector<double> diagonal, entries;
  for (int row = 0; row < size; ++row) {
    diagonal.push_back(matrix(row, row));
    for (int column = 0; column < row; ++column)
      if (matrix(row, column) != 0) {
        places.emplace_back(row, column);
        entries.push_back(matrix(row, column));
      }
  }
  SparseLdlt factor;
  factor.analyze(size, places);
  factor.factorize(diagonal, entries);
  VectorX x = rightHandSide;
  factor.solve(x);
  return x;
}

// Backward stability: |A x - b| <= c n eps |A| |x|; c n = 100 leaves room for 30 rows.
TEST(SparseLdlt, SolvesWhatADenseFactorisationSolves) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    const MatrixX matrix = randomMatrix(30, 60, random) + 1e-3 * MatrixX::Identity(30, 30);
    const VectorX b = VectorX::Random(30);
    const VectorX x = solveSparse(matrix, b);
    EXPECT_LT((matrix * x - b).norm(), 100 * 2.2e-16 * matrix.norm() * x.norm());
    EXPECT_LT((x - matrix.ldlt().solve(b)).norm(), 1e-9 * x.norm());  // condition below 1e5
  }
}

}  // namespace
}  // namespace cradle
