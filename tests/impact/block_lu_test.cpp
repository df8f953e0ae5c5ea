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
  factor.analyze(6, pairs);
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

}  // namespace
}  // namespace cradle
