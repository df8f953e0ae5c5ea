#pragma once

#include <array>
#include <utility>
#include <vector>

#include "math/types.h"

namespace cradle {

using Mat6 = Eigen::Matrix<double, 6, 6>;
using Vec6 = Eigen::Matrix<double, 6, 1>;

/// A 6x6 matrix factorised in place, with row pivoting. Solved by substitution, never by an inverse: what is stiff
/// along some directions then stays exact along them.
class PivotBlock {
 public:
  Mat6 matrix;  // before `factorize`; factors after it

  void factorize();
  void solve(Vec6& x) const;

 private:
  std::array<int, 6> pivots_{};       // rows exchanged with
  std::array<double, 6> inverses_{};  // of the diagonal
};

/// Factorisation of a sparse matrix of 6x6 blocks, one row of blocks for each body, with blocks where bodies touch: as
/// often above the diagonal as below, but with any values. Pivots within diagonal blocks only, so that these must stay
/// regular, as they do for matrices near symmetric positive definite ones. Further rows of blocks may be those of
/// multipliers, whose diagonal blocks are (almost) zero at first: each comes after a body that it is coupled to. O(n)
/// for stacks and chains. Allocates in `analyze` alone.
class BlockLu {
 public:
  /// Takes the number of rows of blocks, those of multipliers last, and the pairs of different ones that have blocks,
  /// each once.
  void analyze(int bodies, int multipliers, const std::vector<std::pair<int, int>>& pairs);

  /// Sets all blocks to zero.
  void clear();

  /// The diagonal block of a body; the block in the row of a pair's first body and the column of its second; and the
  /// other way round. To be filled after `clear`.
  Mat6& diagonal(std::size_t body) { return diagonal_[static_cast<std::size_t>(positionOf_[body])].matrix; }
  Mat6& firstRow(std::size_t pair) { return blocks_[firstRow_[pair]]; }
  Mat6& secondRow(std::size_t pair) { return blocks_[secondRow_[pair]]; }

  void factorize();

  /// Overwrites a right-hand side with the solution.
  void solve(VectorX& x) const;

 private:
  /// A block of the part that is left, changed by the elimination of one position: target -= below x above.
  struct Update {
    std::size_t target, below, above;
    bool isDiagonal;
  };
  std::vector<std::vector<int>> eliminate(int bodies, const std::vector<std::pair<int, int>>& pairs);

  std::vector<int> bodyAt_, positionOf_;           // the order of elimination, and back
  std::vector<std::vector<int>> later_;            // positions that each position is coupled to and that come after it
  std::vector<std::size_t> first_;                 // index of the first of these couplings, of each position
  std::vector<PivotBlock> diagonal_;               // by position
  std::vector<Mat6> blocks_;                       // coupling c: below the diagonal at 2 c, above at 2 c + 1
  std::vector<std::size_t> firstRow_, secondRow_;  // of each pair
  std::vector<std::vector<Update>> updates_;       // of each position
};

}  // namespace cradle
