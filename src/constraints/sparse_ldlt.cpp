// Up-looking factorisation along the elimination tree (T. A. Davis, "Algorithm 849: a concise sparse Cholesky
// factorization package", ACM Trans. Math. Software 31, 2005). The order of elimination is Eigen's approximate minimum
// degree.

#include "constraints/sparse_ldlt.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <numeric>

namespace cradle {
namespace {

// Where most of L is filled, the places of its entries cost more than those that are not.
constexpr std::size_t kMaxDense = 16;  // rows
constexpr double kDenseRatio = 0.5;    // of the entries below the diagonal

}  // namespace

std::vector<int> eliminationOrder(int size, const std::vector<std::pair<int, int>>& entries) {
  std::vector<int> order(static_cast<std::size_t>(size));
  std::iota(order.begin(), order.end(), 0);
  if (entries.empty()) return order;
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& [row, column] : entries)
    triplets.emplace_back(row, column, 1), triplets.emplace_back(column, row, 1);
  for (int row = 0; row < size; ++row) triplets.emplace_back(row, row, 1);
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  std::copy_n(permutation.indices().data(), size, order.begin());
  return order;
}

void SparseLdlt::analyze(int size, const std::vector<std::pair<int, int>>& entries) {
  size_ = size;
  rowAt_ = eliminationOrder(size, entries);
  positionOf_.resize(rowAt_.size());
  for (std::size_t position = 0; position < rowAt_.size(); ++position)
    positionOf_[static_cast<std::size_t>(rowAt_[position])] = static_cast<int>(position);

  rowStart_.assign(static_cast<std::size_t>(size) + 1, 0);
  std::vector<std::pair<std::pair<int, int>, int>> placed;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const int a = positionOf_[static_cast<std::size_t>(entries[i].first)];
    const int b = positionOf_[static_cast<std::size_t>(entries[i].second)];
    placed.push_back({{std::max(a, b), std::min(a, b)}, static_cast<int>(i)});
  }
  std::sort(placed.begin(), placed.end());
  rowEntries_.clear();
  for (const auto& [place, source] : placed) {
    rowEntries_.push_back({place.second, source});
    rowStart_[static_cast<std::size_t>(place.first) + 1] = static_cast<int>(rowEntries_.size());
  }
  for (std::size_t row = 1; row < rowStart_.size(); ++row)
    rowStart_[row] = std::max(rowStart_[row], rowStart_[row - 1]);
  findFill();
}

/// Elimination tree, and the number of entries in each column of L.
void SparseLdlt::findFill() {
  const std::size_t size = static_cast<std::size_t>(size_);
  parents_.assign(size, -1);
  marks_.assign(size, -1);
  pattern_.assign(size, 0);
  work_.assign(size, 0);
  inversePivots_.assign(size, 0);
  columnCount_.assign(size, 0);
  for (int row = 0; row < size_; ++row) {
    marks_[static_cast<std::size_t>(row)] = row;
    for (int e = rowStart_[static_cast<std::size_t>(row)]; e < rowStart_[static_cast<std::size_t>(row) + 1]; ++e)
      for (int node = rowEntries_[static_cast<std::size_t>(e)].column; marks_[static_cast<std::size_t>(node)] != row;) {
        const std::size_t at = static_cast<std::size_t>(node);
        if (parents_[at] < 0) parents_[at] = row;
        ++columnCount_[at];
        marks_[at] = row;
        node = parents_[at];
      }
  }
  columnStart_.assign(size + 1, 0);
  for (std::size_t i = 0; i < size; ++i) columnStart_[i + 1] = columnStart_[i] + columnCount_[i];
  lowerRows_.assign(static_cast<std::size_t>(columnStart_[size]), 0);
  lower_.assign(lowerRows_.size(), 0);
  isDense_ = size <= kMaxDense && columnStart_[size] >= kDenseRatio * (size_ * (size_ - 1) / 2);
  if (isDense_) dense_.assign(size * size, 0);
}

void SparseLdlt::factorize(const std::vector<double>& diagonal, const std::vector<double>& entries) {
  leastPivot_ = 1;
  if (isDense_) return factorizeDense(diagonal, entries);
  std::fill(columnCount_.begin(), columnCount_.end(), 0);
  std::fill(marks_.begin(), marks_.end(), -1);
  for (int row = 0; row < size_; ++row) {
    const std::size_t at = static_cast<std::size_t>(row);
    for (int e = rowStart_[at]; e < rowStart_[at + 1]; ++e) {
      const Entry& entry = rowEntries_[static_cast<std::size_t>(e)];
      work_[static_cast<std::size_t>(entry.column)] += entries[static_cast<std::size_t>(entry.source)];
    }
    eliminate(row, reach(row), diagonal[static_cast<std::size_t>(rowAt_[at])]);
  }
}

/// The same where L is stored whole, column by column: each takes its part of those behind it.
void SparseLdlt::factorizeDense(const std::vector<double>& diagonal, const std::vector<double>& entries) {
  const std::size_t size = static_cast<std::size_t>(size_);
  std::fill(dense_.begin(), dense_.end(), 0.0);
  for (std::size_t row = 0; row < size; ++row) {
    dense_[row * size + row] = diagonal[static_cast<std::size_t>(rowAt_[row])];
    for (int e = rowStart_[row]; e < rowStart_[row + 1]; ++e) {
      const Entry& entry = rowEntries_[static_cast<std::size_t>(e)];
      dense_[static_cast<std::size_t>(entry.column) * size + row] += entries[static_cast<std::size_t>(entry.source)];
    }
  }
  std::array<double, kMaxDense> factors;
  for (std::size_t k = 0; k < size; ++k) {
    double* const column = &dense_[k * size];
    const double pivot = column[k], before = diagonal[static_cast<std::size_t>(rowAt_[k])];
    const double inverse = pivot > 0 ? 1 / pivot : 0;
    leastPivot_ = std::min(leastPivot_, before > 0 ? pivot / before : 0);
    inversePivots_[k] = inverse;
    for (std::size_t i = k + 1; i < size; ++i) factors[i] = column[i] * inverse;
    for (std::size_t j = k + 1; j < size; ++j) {
      double* const behind = &dense_[j * size];
      const double factor = factors[j];
#pragma GCC ivdep
      for (std::size_t i = j; i < size; ++i) behind[i] -= factor * column[i];
    }
    for (std::size_t i = k + 1; i < size; ++i) column[i] = factors[i];
  }
}

/// Of work_, in the order of elimination.
void SparseLdlt::solveDense() {
  const std::size_t size = static_cast<std::size_t>(size_);
  double* const x = work_.data();
  for (std::size_t k = 0; k < size; ++k) {
    const double* const column = &dense_[k * size];
    const double value = x[k];
#pragma GCC ivdep
    for (std::size_t i = k + 1; i < size; ++i) x[i] -= column[i] * value;
  }
  for (std::size_t k = size; k-- > 0;) {
    const double* const column = &dense_[k * size];
    double value = x[k] * inversePivots_[k];
    for (std::size_t i = k + 1; i < size; ++i) value -= column[i] * x[i];
    x[k] = value;
  }
}

/// The columns of L that have an entry in `row`, in an order in which they can be eliminated: from the place returned
/// to the end of pattern_.
int SparseLdlt::reach(int row) {
  int first = size_;
  marks_[static_cast<std::size_t>(row)] = row;
  for (int e = rowStart_[static_cast<std::size_t>(row)]; e < rowStart_[static_cast<std::size_t>(row) + 1]; ++e) {
    int length = 0;
    for (int node = rowEntries_[static_cast<std::size_t>(e)].column; marks_[static_cast<std::size_t>(node)] != row;
         node = parents_[static_cast<std::size_t>(node)]) {
      pattern_[static_cast<std::size_t>(length++)] = node;
      marks_[static_cast<std::size_t>(node)] = row;
    }
    while (length > 0) pattern_[static_cast<std::size_t>(--first)] = pattern_[static_cast<std::size_t>(--length)];
  }
  return first;
}

void SparseLdlt::eliminate(int row, int first, double diagonal) {
  double pivot = diagonal;
  for (int p = first; p < size_; ++p) {
    const std::size_t column = static_cast<std::size_t>(pattern_[static_cast<std::size_t>(p)]);
    const double value = std::exchange(work_[column], 0.0);
    const std::size_t begin = static_cast<std::size_t>(columnStart_[column]);
    const std::size_t end = begin + static_cast<std::size_t>(columnCount_[column]);
    for (std::size_t i = begin; i < end; ++i) work_[static_cast<std::size_t>(lowerRows_[i])] -= lower_[i] * value;
    const double factor = value * inversePivots_[column];
    pivot -= factor * value;
    lowerRows_[end] = row;
    lower_[end] = factor;
    ++columnCount_[column];
  }
  leastPivot_ = std::min(leastPivot_, diagonal > 0 ? pivot / diagonal : 0);
  inversePivots_[static_cast<std::size_t>(row)] = pivot > 0 ? 1 / pivot : 0;
}

void SparseLdlt::solve(VectorX& x) {
  const std::size_t size = static_cast<std::size_t>(size_);
  for (std::size_t i = 0; i < size; ++i) work_[i] = x[rowAt_[i]];
  if (isDense_) {
    solveDense();
    for (std::size_t i = 0; i < size; ++i) x[rowAt_[i]] = std::exchange(work_[i], 0.0);
    return;
  }
  for (std::size_t i = 0; i < size; ++i)
    for (int p = columnStart_[i]; p < columnStart_[i + 1]; ++p)
      work_[static_cast<std::size_t>(lowerRows_[static_cast<std::size_t>(p)])] -=
          lower_[static_cast<std::size_t>(p)] * work_[i];
  for (std::size_t i = size; i-- > 0;) {
    double value = work_[i] * inversePivots_[i];
    for (int p = columnStart_[i]; p < columnStart_[i + 1]; ++p)
      value -= lower_[static_cast<std::size_t>(p)] *
               work_[static_cast<std::size_t>(lowerRows_[static_cast<std::size_t>(p)])];
    work_[i] = value;
  }
  for (std::size_t i = 0; i < size; ++i) x[rowAt_[i]] = std::exchange(work_[i], 0.0);
}

}  // namespace cradle
