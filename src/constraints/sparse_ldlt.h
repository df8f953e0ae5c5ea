#pragma once

#include <utility>
#include <vector>

#include "math/types.h"

namespace cradle {

/// An order in which the rows of a sparse symmetric matrix are best eliminated: few entries are filled. `entries` are
/// the places below its diagonal, each once.
std::vector<int> eliminationOrder(int size, const std::vector<std::pair<int, int>>& entries);

/// Factorisation L D L^T of a sparse symmetric positive definite matrix, with an order of elimination that keeps L
/// sparse: O(n) for chains and trees. A small one that fills up is stored whole. A row without any entry gets the
/// unknown 0. Allocates in `analyze` alone.
class SparseLdlt {
 public:
  /// Takes the places of the entries below the diagonal, each once, row > column.
  void analyze(int size, const std::vector<std::pair<int, int>>& entries);

  /// Factorises the matrix with these values: `diagonal` and, in the order given to analyze, `entries`.
  void factorize(const std::vector<double>& diagonal, const std::vector<double>& entries);

  /// Smallest pivot of the last factorisation as a part of its diagonal entry: near 0 where rows depend on each other.
  double leastPivot() const { return leastPivot_; }

  /// Overwrites a right-hand side with the solution.
  void solve(VectorX& x);

 private:
  struct Entry {
    int column, source;  // position of the column; index into the entries of analyze
  };
  void findFill();
  int reach(int row);
  void eliminate(int row, int first, double diagonal);
  void factorizeDense(const std::vector<double>& diagonal, const std::vector<double>& entries);
  void solveDense();

  int size_ = 0;
  double leastPivot_ = 1;
  std::vector<int> rowAt_, positionOf_;         // the order of elimination, and back
  std::vector<int> rowStart_;                   // of each position, into rowEntries_
  std::vector<Entry> rowEntries_;               // below the diagonal, by position
  std::vector<int> parents_;                    // elimination tree
  std::vector<int> columnStart_, columnCount_;  // L by columns
  std::vector<int> lowerRows_;
  std::vector<double> lower_, inversePivots_;
  std::vector<int> marks_, pattern_;
  bool isDense_ = false;
  std::vector<double> dense_;  // by columns of `size_`: the matrix, then L below the pivots
  std::vector<double> work_;
};

}  // namespace cradle
