#include "impact/block_lu.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <random>

namespace cradle {
namespace {

// A ring with a chord, so that elimination fills in; blocks of any values beside strong diagonals, as pivots within
// diagonal blocks ask for. The oracle is the dense factorisation with pivoting over all rows.
TEST(BlockLu, SolvesAsTheDenseFactorisationDoes) {
  const std::vector<std::pair<int, int>> pairs = {{1, 0}, {2, 1}, {3, 2}, {3, 4}, {5, 4}, {5, 0}, {1, 4}};
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BlockLu factor;
  factor.analyze(6, 0, pairs);
  factor.clear();
  MatrixX dense = MatrixX::Zero(36, 36);
  const auto fill = [&](Mat6& block, Eigen::Index row, Eigen::Index column, double diagonal) {
    for (double& entry : block.reshaped()) entry = uniform(random);
    block.diagonal().array() += diagonal;
    dense.block<6, 6>(6 * row, 6 * column) = block;
  };
  for (std::size_t body = 0; body < 6; ++body)
    fill(factor.diagonal(body), static_cast<Eigen::Index>(body), static_cast<Eigen::Index>(body), 15);
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    fill(factor.firstRow(pair), pairs[pair].first, pairs[pair].second, 0);
    fill(factor.secondRow(pair), pairs[pair].second, pairs[pair].first, 0);
  }
  factor.factorize();
  const VectorX side = VectorX::LinSpaced(36, -1, 3);
  VectorX x = side;
  factor.solve(x);
  EXPECT_LT((x - dense.partialPivLu().solve(side)).norm(), 1e-13 * side.norm());
}

// Bodies in a row with multipliers between neighbours, and one from the first to what is fixed: [K B^T; B 0] with K not
// symmetric. The last has the least degree, and no pivot before its body is eliminated. Each has three rows; those that
// fill up the block are multipliers of nothing.
TEST(BlockLu, TakesMultipliersAfterABodyOfTheirs) {
  constexpr int kBodies = 4, kSize = 6 * 2 * kBodies;
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < kBodies; ++i) {
    pairs.emplace_back(kBodies + i, i);
    if (i > 0) pairs.emplace_back(kBodies + i, i - 1);
  }
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BlockLu factor;
  factor.analyze(kBodies, kBodies, pairs);
  factor.clear();
  MatrixX dense = MatrixX::Zero(kSize, kSize);
  for (int body = 0; body < kBodies; ++body) {
    Mat6& block = factor.diagonal(static_cast<std::size_t>(body));
    for (double& entry : block.reshaped()) entry = uniform(random);
    block.diagonal().array() += 15;
    dense.block<6, 6>(6 * body, 6 * body) = block;
  }
  for (int row = kBodies; row < 2 * kBodies; ++row) {
    factor.diagonal(static_cast<std::size_t>(row)).diagonal().tail<3>().setOnes();
    dense.diagonal().segment<3>(6 * row + 3).setOnes();
  }
  for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
    Mat6& rows = factor.firstRow(pair);
    for (double& entry : rows.topRows<3>().reshaped()) entry = uniform(random);
    factor.secondRow(pair) = rows.transpose();
    dense.block<6, 6>(6 * pairs[pair].first, 6 * pairs[pair].second) = rows;
    dense.block<6, 6>(6 * pairs[pair].second, 6 * pairs[pair].first) = rows.transpose();
  }
  factor.factorize();
  const VectorX side = VectorX::LinSpaced(kSize, -1, 3);
  VectorX x = side;
  factor.solve(x);
  const VectorX exact = dense.partialPivLu().solve(side);
  EXPECT_LT((x - exact).norm(), 1e-12 * exact.norm());
}

}  // namespace
}  // namespace cradle
