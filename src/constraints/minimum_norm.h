#pragma once

#include <vector>

#include "math/types.h"

namespace cradle {

/// Solves (S + C) x = b, S = J M^-1 J^T of rows that may depend on each other: of all x that leave the least of b, the
/// shortest. C is another response of the same rows, J M^-1 F, and zero where nothing slides. Constraints may take
/// their part of S; where they leave a row nothing, it depends on them. O(size^2 rank) to factorise, O(size rank) to
/// solve. Allocates in `resize` alone.
class MinimumNormSolver {
 public:
  void resize(int size);

  /// S, column by column; all of it is read.
  double& symmetric(int row, int column) { return symmetric_[at(row, column)]; }

  /// The diagonal entry of S as it were without constraints: what a row has by itself.
  double& whole(int row) { return whole_[static_cast<std::size_t>(row)]; }

  /// S + C; read if factorize is told so.
  double& coupled(int row, int column) { return coupled_[at(row, column)]; }

  /// Factorises the leading `size` rows and columns. With `sharesLoads` the x that lies in the span of S is taken in
  /// place of the shortest: that of rows that give way in proportion to it.
  void factorize(int size, bool isCoupled, bool sharesLoads = false);

  /// What it was told last.
  bool isCoupled() const { return isCoupled_; }

  /// Number of rows that do not depend on others.
  int rank() const { return rank_; }

  /// Overwrites the leading entries of a right-hand side with the solution.
  void solve(double* x);

 private:
  /// Orthonormal columns Q and a triangular R.
  struct Orthogonal {
    std::vector<double> q, r;
  };
  std::size_t at(int row, int column) const {
    return static_cast<std::size_t>(column) * static_cast<std::size_t>(capacity_) + static_cast<std::size_t>(row);
  }
  void findLower();
  int nextPivot() const;
  void findUpper();
  void projectOnSpan(double* column);
  void orthogonalize(const std::vector<double>& columns, Orthogonal& factor) const;
  void solveOnce(double* x);
  void reduce(const double* b);
  void expand(double* x);
  void substituteBack(double* x);

  int capacity_ = 0, size_ = 0, rank_ = 0;
  bool isCoupled_ = false, sharesLoads_ = false, isWellConditioned_ = true;
  std::vector<double> symmetric_, coupled_, whole_;
  std::vector<double> lower_;         // L of S = L L^T, size x rank
  std::vector<double> upper_;         // K^T of S + C = L K
  std::vector<int> pivots_;           // the row that each column of L begins with
  std::vector<double> inverseBegin_;  // 1 / its entry there
  std::vector<double> remaining_;     // of the diagonal of S
  std::vector<double> inverseWhole_;
  Orthogonal lowerFactor_, upperFactor_;
  std::vector<double> reduced_, residual_;
};

}  // namespace cradle
