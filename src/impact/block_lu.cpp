// Gaussian elimination of blocks in the order of minimum degree (A. George, J. W. H. Liu, "The evolution of the minimum
// degree ordering algorithm", SIAM Review 31, 1989), ties by index.

#include "impact/block_lu.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cradle {
namespace {

using Index = Eigen::Index;

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

void insertOnce(std::vector<int>& sorted, int value) {
  const auto place = std::lower_bound(sorted.begin(), sorted.end(), value);
  if (place == sorted.end() || *place != value) sorted.insert(place, value);
}

}  // namespace

void PivotBlock::factorize() {
  for (Index column = 0; column < 6; ++column) {
    Index pivot = column;
    for (Index row = column + 1; row < 6; ++row)
      if (std::abs(matrix(row, column)) > std::abs(matrix(pivot, column))) pivot = row;
    pivots_[at(static_cast<int>(column))] = static_cast<int>(pivot);
    if (pivot != column) matrix.row(column).swap(matrix.row(pivot));
    const double inverse = 1 / matrix(column, column);
    inverses_[at(static_cast<int>(column))] = inverse;
    for (Index row = column + 1; row < 6; ++row) matrix(row, column) *= inverse;
    for (Index k = column + 1; k < 6; ++k)
      for (Index row = column + 1; row < 6; ++row) matrix(row, k) -= matrix(row, column) * matrix(column, k);
  }
}

void PivotBlock::solve(Vec6& x) const {
  for (Index i = 0; i < 6; ++i)
    if (const Index pivot = pivots_[at(static_cast<int>(i))]; pivot != i) std::swap(x[i], x[pivot]);
  for (Index i = 0; i < 6; ++i)
    for (Index row = i + 1; row < 6; ++row) x[row] -= matrix(row, i) * x[i];
  for (Index i = 5; i >= 0; --i) {
    x[i] *= inverses_[at(static_cast<int>(i))];
    for (Index row = 0; row < i; ++row) x[row] -= matrix(row, i) * x[i];
  }
}

/// Chooses the order. Returns the rows that each row is coupled to when its turn comes.
std::vector<std::vector<int>> BlockLu::eliminate(int bodies, const std::vector<std::pair<int, int>>& pairs) {
  const int rows = static_cast<int>(positionOf_.size());
  std::vector<std::vector<int>> neighbours(positionOf_.size());
  std::vector<char> mayBeNext(positionOf_.size(), 0);
  std::fill_n(mayBeNext.begin(), bodies, 1);
  for (const auto& [a, b] : pairs) insertOnce(neighbours[at(a)], b), insertOnce(neighbours[at(b)], a);
  std::vector<char> isDone(positionOf_.size(), 0);
  for (int position = 0; position < rows; ++position) {
    int next = -1;
    for (int row = 0; row < rows; ++row)
      if (mayBeNext[at(row)] && !isDone[at(row)] &&
          (next < 0 || neighbours[at(row)].size() < neighbours[at(next)].size()))
        next = row;
    isDone[at(next)] = 1;
    bodyAt_[at(position)] = next, positionOf_[at(next)] = position;
    const std::vector<int>& coupled = neighbours[at(next)];
    for (const int one : coupled) {
      mayBeNext[at(one)] = mayBeNext[at(one)] || next < bodies;
      std::erase(neighbours[at(one)], next);
      for (const int other : coupled)
        if (other != one) insertOnce(neighbours[at(one)], other);
    }
  }
  return neighbours;
}

void BlockLu::analyze(int bodies, int multipliers, const std::vector<std::pair<int, int>>& pairs) {
  const std::size_t rows = at(bodies + multipliers);
  bodyAt_.assign(rows, 0), positionOf_.assign(rows, 0);
  const std::vector<std::vector<int>> coupled = eliminate(bodies, pairs);
  later_.assign(rows, {}), first_.assign(rows, 0), updates_.assign(rows, {});
  std::size_t couplings = 0;
  for (std::size_t position = 0; position < rows; ++position) {
    for (const int body : coupled[at(bodyAt_[position])]) later_[position].push_back(positionOf_[at(body)]);
    std::sort(later_[position].begin(), later_[position].end());
    first_[position] = couplings;
    couplings += later_[position].size();
  }
  diagonal_.resize(rows);
  blocks_.resize(2 * couplings);
  const auto couplingOf = [this](int early, int late) {
    const std::vector<int>& later = later_[at(early)];
    return first_[at(early)] +
           static_cast<std::size_t>(std::lower_bound(later.begin(), later.end(), late) - later.begin());
  };
  for (std::size_t position = 0; position < rows; ++position)
    for (std::size_t i = 0; i < later_[position].size(); ++i)
      for (std::size_t k = 0; k < later_[position].size(); ++k) {
        const int row = later_[position][i], column = later_[position][k];
        const std::size_t target = row == column  ? at(row)
                                   : row > column ? 2 * couplingOf(column, row)
                                                  : 2 * couplingOf(row, column) + 1;
        updates_[position].push_back(
            {target, 2 * (first_[position] + i), 2 * (first_[position] + k) + 1, row == column});
      }
  firstRow_.clear(), secondRow_.clear();
  for (const auto& [a, b] : pairs) {
    const int rowA = positionOf_[at(a)], rowB = positionOf_[at(b)];
    const std::size_t coupling = couplingOf(std::min(rowA, rowB), std::max(rowA, rowB));
    firstRow_.push_back(2 * coupling + (rowA > rowB ? 0 : 1));
    secondRow_.push_back(2 * coupling + (rowA > rowB ? 1 : 0));
  }
}

void BlockLu::clear() {
  for (PivotBlock& block : diagonal_) block.matrix.setZero();
  for (Mat6& block : blocks_) block.setZero();
}

void BlockLu::factorize() {
  for (std::size_t position = 0; position < diagonal_.size(); ++position) {
    diagonal_[position].factorize();
    for (std::size_t i = 0; i < later_[position].size(); ++i) {
      Mat6& above = blocks_[2 * (first_[position] + i) + 1];
      for (Index column = 0; column < 6; ++column) {
        Vec6 x = above.col(column);
        diagonal_[position].solve(x);
        above.col(column) = x;
      }
    }
    for (const Update& update : updates_[position]) {
      Mat6& target = update.isDiagonal ? diagonal_[update.target].matrix : blocks_[update.target];
      target -= blocks_[update.below].lazyProduct(blocks_[update.above]);
    }
  }
}

void BlockLu::solve(VectorX& x) const {
  for (std::size_t position = 0; position < diagonal_.size(); ++position) {
    Vec6 own = x.segment<6>(6 * bodyAt_[position]);
    diagonal_[position].solve(own);
    x.segment<6>(6 * bodyAt_[position]) = own;
    for (std::size_t i = 0; i < later_[position].size(); ++i)
      x.segment<6>(6 * bodyAt_[at(later_[position][i])]) -= blocks_[2 * (first_[position] + i)].lazyProduct(own);
  }
  for (std::size_t position = diagonal_.size(); position-- > 0;)
    for (std::size_t i = 0; i < later_[position].size(); ++i)
      x.segment<6>(6 * bodyAt_[position]) -=
          blocks_[2 * (first_[position] + i) + 1].lazyProduct(x.segment<6>(6 * bodyAt_[at(later_[position][i])]));
}

}  // namespace cradle
