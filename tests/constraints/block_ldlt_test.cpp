#include "constraints/block_ldlt.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

namespace cradle {
namespace {

/// A symmetric matrix of blocks, with the places beside the diagonal that are not empty.
struct BlockMatrix {
  std::vector<int> sizes;
  MatrixX matrix;
  std::vector<std::pair<int, int>> places;

  Eigen::Index firstRow(int block) const {
    Eigen::Index row = 0;
    for (int i = 0; i < block; ++i) row += sizes[static_cast<std::size_t>(i)];
    return row;
  }
  auto at(int row, int column) {
    return matrix.block(firstRow(row), firstRow(column), sizes[static_cast<std::size_t>(row)],
                        sizes[static_cast<std::size_t>(column)]);
  }
  void findPlaces() {
    const int blocks = static_cast<int>(sizes.size());
    for (int row = 0; row < blocks; ++row)
      for (int column = 0; column < row; ++column)
        if (!at(row, column).isZero(0)) places.emplace_back(row, column);
  }
};

const std::vector<std::vector<int>> kSizes = {
    {1}, {3}, {1, 1, 1}, {3, 3, 3, 3}, {5, 5, 5}, {1, 3, 5, 2, 6, 4, 1, 3}, {6, 1, 5, 3, 1, 1, 3, 5, 2, 2, 4, 3}};

/// B B^T of a random B with blocks of columns, of which each block of rows has two: positive semi-definite, and sparse.
BlockMatrix randomBlocks(const std::vector<int>& sizes, std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  BlockMatrix blocks{sizes, {}, {}};
  const int count = static_cast<int>(sizes.size());
  const Eigen::Index size = blocks.firstRow(count);
  std::uniform_int_distribution<int> place(0, count - 1);
  MatrixX b = MatrixX::Zero(size, 6 * count);
  for (int row = 0; row < count; ++row)
    for (int i = 0; i < 2; ++i) {
      auto block = b.block(blocks.firstRow(row), 6 * place(random), sizes[static_cast<std::size_t>(row)], 6);
      block = MatrixX::NullaryExpr(block.rows(), 6, [&] { return number(random); });
    }
  blocks.matrix = b * b.transpose();
  return blocks;
}

BlockLdlt factorOf(BlockMatrix blocks, double regularisation = 0) {
  blocks.findPlaces();
  BlockLdlt factor;
  factor.analyze(blocks.sizes, blocks.places);
  const auto put = [](const MatrixX& block, double* values) { std::copy_n(block.data(), block.size(), values); };
  for (int i = 0; i < static_cast<int>(blocks.sizes.size()); ++i)
    put(blocks.at(i, i), factor.diagonal(static_cast<std::size_t>(i)));
  for (std::size_t i = 0; i < blocks.places.size(); ++i)
    put(blocks.at(blocks.places[i].first, blocks.places[i].second), factor.beside(i));
  factor.factorize(regularisation);
  return factor;
}

VectorX solved(const BlockMatrix& blocks, const VectorX& rightHandSide, double regularisation = 0) {
  VectorX x = rightHandSide;
  factorOf(blocks, regularisation).solve(x);
  return x;
}

// Backward stability: |A x - b| <= c n eps |A| |x|; c n = 100 leaves room for 40 rows.
constexpr double kBackward = 100 * 2.2e-16;

TEST(BlockLdlt, SolvesWhatADenseFactorisationSolves) {
  std::mt19937 random(7);
  for (const std::vector<int>& sizes : kSizes)
    for (int trial = 0; trial < 20; ++trial) {
      BlockMatrix blocks = randomBlocks(sizes, random);
      blocks.matrix.diagonal().array() += 1e-3;
      const VectorX b = VectorX::Random(blocks.matrix.rows()), x = solved(blocks, b);
      EXPECT_LT((blocks.matrix * x - b).norm(), kBackward * blocks.matrix.norm() * x.norm()) << sizes.size();
      EXPECT_LT((x - blocks.matrix.ldlt().solve(b)).norm(), 1e-9 * x.norm()) << sizes.size();  // condition below 1e5
    }
}

TEST(BlockLdlt, RegularisationIsAPartOfTheDiagonal) {
  std::mt19937 random(11);
  for (const std::vector<int>& sizes : kSizes) {
    BlockMatrix blocks = randomBlocks(sizes, random);
    const VectorX b = VectorX::Random(blocks.matrix.rows()), x = solved(blocks, b, 0.01);
    const MatrixX regular = blocks.matrix + MatrixX(0.01 * blocks.matrix.diagonal().asDiagonal());
    EXPECT_LT((regular * x - b).norm(), kBackward * regular.norm() * x.norm()) << sizes.size();
    // What is left is of the matrix itself: for steps of refinement.
    VectorX left = b;
    factorOf(blocks, 0.01).subtractProduct(x, left);
    EXPECT_LT((left - (b - blocks.matrix * x)).norm(), kBackward * blocks.matrix.norm() * x.norm()) << sizes.size();
  }
}

// Where a row stands twice, only rounding is left of one of its pivots. Else none is below the least eigenvalue, which
// is 1 at least, and no diagonal entry above 1 + 12 x 1.
TEST(BlockLdlt, LeastPivotTellsOfRowsThatDependOnOthers) {
  std::mt19937 random(3);
  for (const std::vector<int>& sizes : kSizes) {
    BlockMatrix blocks = randomBlocks(sizes, random);
    blocks.matrix.diagonal().array() += 1;
    EXPECT_GE(factorOf(blocks).leastPivot(), 1.0 / 13) << sizes.size();
    const Eigen::Index last = blocks.matrix.rows() - 1;
    if (last == 0) continue;
    blocks.matrix.row(last) = blocks.matrix.row(0);
    blocks.matrix.col(last) = blocks.matrix.col(0);
    EXPECT_LT(std::abs(factorOf(blocks).leastPivot()), 1e-14) << sizes.size();
  }
}

// Rows without an entry, as of what is fixed on both sides, and what they are given: nothing comes out.
TEST(BlockLdlt, RowsOfZerosGetNothing) {
  std::mt19937 random(5);
  for (const std::vector<int>& sizes : kSizes) {
    BlockMatrix blocks = randomBlocks(sizes, random);
    blocks.matrix.diagonal().array() += 1;
    const Eigen::Index empty = blocks.matrix.rows() / 2;
    blocks.matrix.row(empty).setZero(), blocks.matrix.col(empty).setZero();
    VectorX b = VectorX::Random(blocks.matrix.rows());
    b[empty] = 1;
    const VectorX x = solved(blocks, b);
    EXPECT_EQ(x[empty], 0) << sizes.size();
    b[empty] = 0;
    EXPECT_LT((blocks.matrix * x - b).norm(), kBackward * (1 + blocks.matrix.norm() * x.norm())) << sizes.size();
    EXPECT_EQ(factorOf(blocks).leastPivot(), 0) << sizes.size();
  }
}

// A chain that is given from its middle outwards stays a chain: no block is filled in, whatever the order of its
// places.
TEST(BlockLdlt, SolvesChainsInAnyOrderOfPlaces) {
  for (const bool isTurned : {false, true}) {
    BlockLdlt factor;
    std::vector<std::pair<int, int>> places;
    const int count = 50;
    for (int i = 1; i < count; ++i) places.emplace_back(isTurned ? i - 1 : i, isTurned ? i : i - 1);
    factor.analyze(std::vector<int>(count, 1), places);
    for (std::size_t i = 0; i < count; ++i) *factor.diagonal(i) = 2;
    for (std::size_t i = 0; i + 1 < count; ++i) *factor.beside(i) = -1;
    factor.factorize();
    VectorX x = VectorX::Ones(count);
    factor.solve(x);
    // -x[i-1] + 2 x[i] - x[i+1] = 1 with ends at zero: x[i] = (i + 1)(n - i) / 2, up to 325; rounding grows by n^2.
    for (int i = 0; i < count; ++i) EXPECT_NEAR(x[i], (i + 1) * (count - i) / 2.0, 1e-11) << i;
  }
}

}  // namespace
}  // namespace cradle
