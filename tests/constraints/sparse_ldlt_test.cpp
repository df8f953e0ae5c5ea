#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "constraints/sparse_ldlt.h"

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

SparseLdlt factorOf(const MatrixX& matrix) {
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
  return factor;
}

/// Solves `matrix` x = rightHandSide with the sparse factorisation.
VectorX solveSparse(const MatrixX& matrix, const VectorX& rightHandSide) {
  VectorX x = rightHandSide;
  factorOf(matrix).solve(x);
  return x;
}

// Backward stability: |A x - b| <= c n eps |A| |x|; c n = 100 leaves room for 30 rows. Small ones are factorised whole.
TEST(SparseLdlt, SolvesWhatADenseFactorisationSolves) {
  std::mt19937 random(7);
  for (const int size : {1, 2, 6, 16, 17, 30})
    for (int trial = 0; trial < 20; ++trial) {
      const int columns = trial % 2 == 0 ? 3 : 2 * size;  // full, or with places that stay empty
      const MatrixX matrix = randomMatrix(size, columns, random) + 1e-3 * MatrixX::Identity(size, size);
      const VectorX b = VectorX::Random(size);
      const VectorX x = solveSparse(matrix, b);
      EXPECT_LT((matrix * x - b).norm(), 100 * 2.2e-16 * matrix.norm() * x.norm()) << size;
      EXPECT_LT((x - matrix.ldlt().solve(b)).norm(), 1e-9 * x.norm()) << size;  // condition below 1e5
    }
}

// Where a row stands twice, only rounding is left of one of its pivots. Else none is below the least eigenvalue, which
// is 1 at least, and no diagonal entry above 1 + 3 x 1.
TEST(SparseLdlt, LeastPivotTellsOfRowsThatDependOnOthers) {
  std::mt19937 random(3);
  for (const int size : {6, 16, 17, 30}) {
    const MatrixX regular = randomMatrix(size, 3, random) + MatrixX::Identity(size, size);
    MatrixX twice = regular;
    twice.row(1) = twice.row(0);
    twice.col(1) = twice.col(0);
    EXPECT_LT(std::abs(factorOf(twice).leastPivot()), 1e-14) << size;
    EXPECT_GE(factorOf(regular).leastPivot(), 0.25) << size;
  }
}

// Rows without an entry, as of what is fixed on both sides, and what they are given: nothing comes out.
TEST(SparseLdlt, RowsOfZerosGetNothing) {
  std::mt19937 random(5);
  for (const int size : {6, 16, 17, 30}) {
    MatrixX matrix = randomMatrix(size, 3, random) + MatrixX::Identity(size, size);
    matrix.row(2).setZero(), matrix.col(2).setZero();
    VectorX b = VectorX::Random(size);
    b[2] = 1;
    const VectorX x = solveSparse(matrix, b);
    EXPECT_EQ(x[2], 0) << size;
    b[2] = 0;
    EXPECT_LT((matrix * x - b).norm(), 100 * 2.2e-16 * matrix.norm() * x.norm()) << size;
    EXPECT_EQ(factorOf(matrix).leastPivot(), 0) << size;
  }
}

}  // namespace
}  // namespace cradle
