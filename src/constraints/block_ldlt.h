#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "math/types.h"

namespace cradle {

/// Factorisation L D L^T of a sparse symmetric positive semi-definite matrix of dense blocks, with an order of
/// elimination that keeps L sparse: O(n) for chains and trees. A row that nothing is left of gets the unknown 0.
/// Allocates in `analyze` alone.
class BlockLdlt {
 public:
  /// Takes the number of rows of each diagonal block, and the places (row, column) of the blocks beside the diagonal,
  /// each once, in either order. Turns places round so that the row is eliminated after the column.
  void analyze(const std::vector<int>& sizes, std::vector<std::pair<int, int>>& places);

  /// Blocks of the matrix, stored by columns, to be filled before `factorize`; of a diagonal one all entries.
  double* diagonal(std::size_t block) { return &matrix_[offsets_[block]]; }
  double* beside(std::size_t place) { return &matrix_[offsets_[sizes_.size() + place]]; }

  /// Factorises the matrix, with its diagonal times 1 + `regularisation`.
  void factorize(double regularisation = 0);

  /// Smallest pivot of the last factorisation as a part of its diagonal entry: near 0 where rows depend on each other.
  double leastPivot() const { return leastPivot_; }

  /// Overwrites a right-hand side with the solution.
  void solve(VectorX& x) const;

  /// Subtracts matrix times x, without a regularisation, from y.
  void subtractProduct(const VectorX& x, VectorX& y) const;

 private:
  /// A block below the diagonal: its rows are those of a later diagonal block.
  struct Below {
    std::size_t offset;
    Eigen::Index firstRow;
    int rows;
  };
  /// What the elimination of a column changes in the rest of the matrix: target -= left x D x right^T.
  struct Update {
    std::size_t target, left, right;  // offsets of blocks
    int rows, columns;
  };
  /// A diagonal block with the range of its blocks below, and of its updates.
  struct Column {
    int size = 0;
    Eigen::Index firstRow = 0;
    std::size_t offset = 0, below = 0, belowEnd = 0, updates = 0, updatesEnd = 0;
  };
  template <class Size>
  double eliminate(const Column& column, Size size, double regularisation);

  std::vector<Column> columns_;  // in the order of elimination
  std::vector<Below> below_;
  std::vector<Update> updates_;
  std::vector<int> sizes_;  // of the diagonal blocks, as they were given
  std::vector<Eigen::Index> firstRows_;
  std::vector<std::pair<int, int>> places_;
  std::vector<std::size_t> offsets_;  // of each block: those of the diagonal, of the places, and what is filled in
  std::vector<double> matrix_;        // the blocks of the matrix, without what is filled in
  std::vector<double> factor_;        // L below the diagonal
  std::vector<double> scaled_;        // L D below the diagonal
  VectorX inversePivots_;
  double leastPivot_ = 1;
};

}  // namespace cradle
