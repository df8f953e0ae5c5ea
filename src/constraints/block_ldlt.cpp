// Right-looking elimination by blocks (G. H. Golub, C. F. Van Loan, "Matrix Computations", 2013, 4.2 and 11.1), in
// Eigen's approximate minimum degree order of the blocks. What each elimination changes is found once, by `analyze`.

#include "constraints/block_ldlt.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <map>
#include <numeric>
#include <type_traits>
#include <utility>

namespace cradle {
namespace {

/// An order in which the blocks are best eliminated: few are filled in.
std::vector<std::size_t> eliminationOrder(int size, const std::vector<std::pair<int, int>>& places) {
  std::vector<std::size_t> order(static_cast<std::size_t>(size));
  std::iota(order.begin(), order.end(), 0);
  if (places.empty()) return order;
  using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& [row, column] : places) triplets.emplace_back(row, column, 1), triplets.emplace_back(column, row, 1);
  for (int row = 0; row < size; ++row) triplets.emplace_back(row, row, 1);
  Matrix matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::AMDOrdering<int>()(matrix, permutation);
  std::copy_n(permutation.indices().data(), size, order.begin());
  return order;
}

/// Calls visit(size) with a number of rows that the compiler knows, if it is that of a kind of constraint.
template <class Visit>
auto withSize(int size, const Visit& visit) {
  if (size == 1) return visit(std::integral_constant<int, 1>());
  if (size == 3) return visit(std::integral_constant<int, 3>());
  if (size == 5) return visit(std::integral_constant<int, 5>());
  if (size == 6) return visit(std::integral_constant<int, 6>());
  return visit(size);
}

constexpr int kMaxSize = 6;  // rows of a constraint: it leaves a body nothing
template <class Size>
constexpr int kSizeOf = Size::value;
template <class Size>
constexpr int kMaxOf = Size::value;
template <>
constexpr int kSizeOf<int> = Eigen::Dynamic;
template <>
constexpr int kMaxOf<int> = kMaxSize;

template <class Rows, class Columns>
using Block = Eigen::Matrix<double, kSizeOf<Rows>, kSizeOf<Columns>>;
template <class Size>
using Segment = Eigen::Matrix<double, kSizeOf<Size>, 1, Eigen::ColMajor, kMaxOf<Size>, 1>;

/// A block, stored by columns, as a matrix.
template <class Rows, class Columns>
Eigen::Map<Block<Rows, Columns>> blockAt(double* values, Rows rows, Columns columns) {
  return {values, rows, columns};
}
template <class Rows, class Columns>
Eigen::Map<const Block<Rows, Columns>> blockAt(const double* values, Rows rows, Columns columns) {
  return {values, rows, columns};
}
template <class Size>
auto segment(VectorX& x, Eigen::Index first, Size size) {
  return x.segment<kSizeOf<Size>>(first, size);
}

}  // namespace

void BlockLdlt::analyze(const std::vector<int>& sizes, std::vector<std::pair<int, int>>& places) {
  const std::size_t size = sizes.size();
  const std::vector<std::size_t> order = eliminationOrder(static_cast<int>(size), places);
  std::vector<std::size_t> positions(size);
  for (std::size_t i = 0; i < size; ++i) positions[order[i]] = i;
  for (auto& [row, column] : places)
    if (positions[static_cast<std::size_t>(row)] < positions[static_cast<std::size_t>(column)]) std::swap(row, column);
  places_ = places;
  sizes_ = sizes;

  offsets_.clear(), below_.clear(), updates_.clear();
  std::size_t entries = 0;
  const auto addBlock = [&](int rows, int columns) {
    offsets_.push_back(entries);
    entries += static_cast<std::size_t>(rows * columns);
  };
  firstRows_.clear();
  Eigen::Index rows = 0;
  for (const int each : sizes) {
    firstRows_.push_back(rows);
    rows += each;
    addBlock(each, each);
  }
  // Blocks below the diagonal of each column, by the position of their row.
  std::vector<std::map<std::size_t, std::size_t>> belowOf(size);
  const auto blockAt = [&](std::size_t row, std::size_t column) {
    const auto [found, isNew] = belowOf[column].try_emplace(positions[row], offsets_.size());
    if (isNew) addBlock(sizes[row], sizes[column]);
    return found->second;
  };
  for (const auto& [row, column] : places) blockAt(static_cast<std::size_t>(row), static_cast<std::size_t>(column));
  matrix_.assign(entries, 0);

  columns_.clear();
  for (const std::size_t block : order) {
    Column& column = columns_.emplace_back();
    column.size = sizes[block], column.firstRow = firstRows_[block], column.offset = offsets_[block];
    column.below = below_.size(), column.updates = updates_.size();
    for (auto right = belowOf[block].begin(); right != belowOf[block].end(); ++right) {
      const std::size_t other = order[right->first];
      below_.push_back({offsets_[right->second], firstRows_[other], sizes[other]});
      for (auto left = right; left != belowOf[block].end(); ++left) {
        const std::size_t row = order[left->first], target = row == other ? row : blockAt(row, other);
        updates_.push_back(
            {offsets_[target], offsets_[left->second], offsets_[right->second], sizes[row], sizes[other]});
      }
    }
    column.belowEnd = below_.size(), column.updatesEnd = updates_.size();
  }
  factor_.assign(entries, 0);
  scaled_.assign(entries, 0);
  inversePivots_.setZero(rows);
}

void BlockLdlt::factorize(double regularisation) {
  std::copy(matrix_.begin(), matrix_.end(), factor_.begin());
  std::fill(factor_.begin() + static_cast<std::ptrdiff_t>(matrix_.size()), factor_.end(), 0.0);
  leastPivot_ = 1;
  for (const Column& column : columns_)
    leastPivot_ = std::min(leastPivot_,
                           withSize(column.size, [&](auto size) { return eliminate(column, size, regularisation); }));
}

/// L D L^T of a diagonal block, of which the lower triangle counts, and what it changes in the rest of the matrix.
/// Returns the smallest entry of D as a part of what stood there before the elimination of others.
template <class Size>
double BlockLdlt::eliminate(const Column& column, Size size, double regularisation) {
  auto diagonal = blockAt(&factor_[column.offset], size, size);
  const auto before = blockAt(std::as_const(matrix_).data() + column.offset, size, size);
  auto inverse = segment(inversePivots_, column.firstRow, size);
  double least = 1;
  for (Eigen::Index k = 0; k < size; ++k) {
    const double entry = before(k, k), pivot = diagonal(k, k) + regularisation * entry;
    if (!(pivot >= least * entry && entry > 0)) least = entry > 0 ? pivot / entry : 0;
    inverse[k] = pivot > 0 ? 1 / pivot : 0;
    for (Eigen::Index other = k + 1; other < size; ++other) {
      const double factor = diagonal(other, k) * inverse[k];
      for (Eigen::Index row = other; row < size; ++row) diagonal(row, other) -= factor * diagonal(row, k);
    }
    for (Eigen::Index row = k + 1; row < size; ++row) diagonal(row, k) *= inverse[k];
  }
  const auto divide = [&](std::size_t offset, auto rows) {  // scaled = A L^-T, A = scaled D^-1
    auto block = blockAt(&factor_[offset], rows, size), scaled = blockAt(&scaled_[offset], rows, size);
    for (Eigen::Index k = 0; k < size; ++k) {
      scaled.col(k) = block.col(k);
      for (Eigen::Index i = 0; i < k; ++i) scaled.col(k) -= diagonal(k, i) * scaled.col(i);
      block.col(k) = inverse[k] * scaled.col(k);
    }
  };
  for (std::size_t i = column.below; i < column.belowEnd; ++i)
    if (below_[i].rows == size)
      divide(below_[i].offset, size);
    else
      divide(below_[i].offset, below_[i].rows);
  const auto change = [&](const Update& update, auto rows, auto columns) {
    blockAt(&factor_[update.target], rows, columns) -=
        blockAt(&factor_[update.left], rows, size)
            .lazyProduct(blockAt(&scaled_[update.right], columns, size).transpose());
  };
  for (std::size_t i = column.updates; i < column.updatesEnd; ++i) {
    const Update& update = updates_[i];
    if (update.rows == size && update.columns == size)
      change(update, size, size);
    else
      change(update, update.rows, update.columns);
  }
  return least;
}

void BlockLdlt::solve(VectorX& x) const {
  for (const Column& column : columns_)
    withSize(column.size, [&](auto size) {
      const auto diagonal = blockAt(&factor_[column.offset], size, size);
      auto own = segment(x, column.firstRow, size);
      for (Eigen::Index k = 0; k < size; ++k)
        for (Eigen::Index row = k + 1; row < size; ++row) own[row] -= diagonal(row, k) * own[k];
      const auto subtract = [&](const Below& below, auto rows) {
        segment(x, below.firstRow, rows) -= blockAt(&factor_[below.offset], rows, size).lazyProduct(own);
      };
      for (std::size_t i = column.below; i < column.belowEnd; ++i)
        if (below_[i].rows == size)
          subtract(below_[i], size);
        else
          subtract(below_[i], below_[i].rows);
    });
  for (auto column = columns_.rbegin(); column != columns_.rend(); ++column)
    withSize(column->size, [&](auto size) {
      const auto diagonal = blockAt(&factor_[column->offset], size, size);
      Segment<decltype(size)> own =
          segment(x, column->firstRow, size).cwiseProduct(inversePivots_.segment(column->firstRow, size));
      const auto subtract = [&](const Below& below, auto rows) {
        own -= blockAt(&factor_[below.offset], rows, size).transpose().lazyProduct(segment(x, below.firstRow, rows));
      };
      for (std::size_t i = column->below; i < column->belowEnd; ++i)
        if (below_[i].rows == size)
          subtract(below_[i], size);
        else
          subtract(below_[i], below_[i].rows);
      for (Eigen::Index k = size; k-- > 0;)
        for (Eigen::Index row = k + 1; row < size; ++row) own[k] -= diagonal(row, k) * own[row];
      segment(x, column->firstRow, size) = own;
    });
}

void BlockLdlt::subtractProduct(const VectorX& x, VectorX& y) const {
  for (const Column& column : columns_)
    y.segment(column.firstRow, column.size) -=
        blockAt(&matrix_[column.offset], column.size, column.size).lazyProduct(x.segment(column.firstRow, column.size));
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const std::size_t row = static_cast<std::size_t>(places_[i].first);
    const std::size_t column = static_cast<std::size_t>(places_[i].second);
    const auto block = blockAt(&matrix_[offsets_[sizes_.size() + i]], sizes_[row], sizes_[column]);
    y.segment(firstRows_[row], sizes_[row]) -= block.lazyProduct(x.segment(firstRows_[column], sizes_[column]));
    y.segment(firstRows_[column], sizes_[column]) -=
        block.transpose().lazyProduct(x.segment(firstRows_[row], sizes_[row]));
  }
}

}  // namespace cradle
