// Cholesky's factorisation with diagonal pivoting reveals the rank (N. J. Higham, "Accuracy and Stability of Numerical
// Algorithms", 2nd ed., 2002, section 10.3): S = L L^T, L of full column rank, in exact arithmetic L = J M^-1/2 Q^T
// with Q an orthonormal basis of what the rows span. S + C then is L K, K = L^T + Q M^-1/2 F: the columns of C lie in
// the same span. The least squares solution y of L y = b and the shortest x with K x = y come from L and K^T each made
// orthogonal by Gram and Schmidt's modified method. Rows without dependence need neither: L y = b is solved by
// substitution, and without C so is L^T x = y.

#include "constraints/minimum_norm.h"

#include <cmath>

namespace cradle {
namespace {

// Of a row's diagonal entry without constraints: what is left of a row that depends on others, squared. Contacts less
// than a millionth of a body's size apart are one, and rounding leaves 1e-16.
constexpr double kDependent = 1e-12;
constexpr double kGoodPivot = 0.1;         // of the same: no need to look for a better one
constexpr double kWellConditioned = 1e-3;  // a least pivot above leaves no error worth a refinement
constexpr double kVanished = 1e-6;         // of a column: what rounding leaves of one that depends on others

/// Two sums, so that additions need not wait for each other.
double dot(const double* a, const double* b, int size) {
  double even = 0, odd = 0;
  for (int i = 0; i + 1 < size; i += 2) {
    even += a[i] * b[i];
    odd += a[i + 1] * b[i + 1];
  }
  if (size % 2 != 0) even += a[size - 1] * b[size - 1];
  return even + odd;
}

void subtract(double factor, const double* from, double* column, int size) {
  for (int i = 0; i < size; ++i) column[i] -= factor * from[i];
}

}  // namespace

void MinimumNormSolver::resize(int size) {
  capacity_ = size;
  const std::size_t rows = static_cast<std::size_t>(size);
  for (std::vector<double>* matrix :
       {&symmetric_, &coupled_, &lower_, &upper_, &lowerFactor_.q, &lowerFactor_.r, &upperFactor_.q, &upperFactor_.r})
    matrix->assign(rows * rows, 0);
  for (std::vector<double>* vector : {&whole_, &remaining_, &inverseWhole_, &inverseBegin_, &reduced_, &residual_})
    vector->assign(rows, 0);
  pivots_.assign(rows, 0);
}

void MinimumNormSolver::factorize(int size, bool isCoupled, bool sharesLoads) {
  size_ = size;
  sharesLoads_ = sharesLoads;
  isCoupled_ = isCoupled;
  findLower();
  if (rank_ < size_) orthogonalize(lower_, lowerFactor_);
  if (!isCoupled_) return;
  findUpper();
  orthogonalize(upper_, upperFactor_);
}

void MinimumNormSolver::findLower() {
  if (size_ == 1 && symmetric_[0] > kDependent * whole_[0]) {  // a contact by itself: all there is in many scenes
    const double scale = 1 / std::sqrt(symmetric_[0]);
    isWellConditioned_ = true;
    rank_ = 1;
    pivots_[0] = 0;
    lower_[0] = symmetric_[0] * scale;
    inverseBegin_[0] = scale;
    return;
  }
  for (int row = 0; row < size_; ++row) {
    const double whole = whole_[static_cast<std::size_t>(row)];
    remaining_[static_cast<std::size_t>(row)] = symmetric_[at(row, row)];
    inverseWhole_[static_cast<std::size_t>(row)] = whole > 0 ? 1 / whole : 0;
  }
  isWellConditioned_ = true;
  for (rank_ = 0; rank_ < size_; ++rank_) {
    const int pivot = nextPivot();
    if (pivot < 0) return;
    const double left = remaining_[static_cast<std::size_t>(pivot)];
    if (left < kWellConditioned * whole_[static_cast<std::size_t>(pivot)]) isWellConditioned_ = false;
    pivots_[static_cast<std::size_t>(rank_)] = pivot;
    double* column = &lower_[at(0, rank_)];
    for (int row = 0; row < size_; ++row) column[row] = symmetric_[at(row, pivot)];
    for (int k = 0; k < rank_; ++k) subtract(lower_[at(pivot, k)], &lower_[at(0, k)], column, size_);
    for (int k = 0; k < rank_; ++k) column[pivots_[static_cast<std::size_t>(k)]] = 0;
    const double scale = 1 / std::sqrt(left);
    for (int row = 0; row < size_; ++row) {
      column[row] *= scale;
      remaining_[static_cast<std::size_t>(row)] -= column[row] * column[row];
    }
    column[pivot] = left * scale;
    remaining_[static_cast<std::size_t>(pivot)] = 0;
    inverseBegin_[static_cast<std::size_t>(rank_)] = scale;
  }
}

/// The first row of which enough is left, as a part of its diagonal entry, or else the one of which most is left; -1 if
/// nothing is left of any.
int MinimumNormSolver::nextPivot() const {
  int next = -1;
  double most = kDependent;
  for (int row = 0; row < size_; ++row) {
    const double part = remaining_[static_cast<std::size_t>(row)] * inverseWhole_[static_cast<std::size_t>(row)];
    if (part > kGoodPivot) return row;
    if (!(part > most)) continue;
    most = part;
    next = row;
  }
  return next;
}

/// K^T from the rows of S + C where the columns of L begin.
void MinimumNormSolver::findUpper() {
  for (int k = 0; k < rank_; ++k) {
    const int pivot = pivots_[static_cast<std::size_t>(k)];
    double* column = &upper_[at(0, k)];
    for (int i = 0; i < size_; ++i) column[i] = coupled_[at(pivot, i)];
    for (int j = 0; j < k; ++j) subtract(lower_[at(pivot, j)], &upper_[at(0, j)], column, size_);
    const double scale = inverseBegin_[static_cast<std::size_t>(k)];
    for (int i = 0; i < size_; ++i) column[i] *= scale;
    if (sharesLoads_ && rank_ < size_) projectOnSpan(column);
  }
}

/// Takes out of a column what does not lie in the span of the columns of L.
void MinimumNormSolver::projectOnSpan(double* column) {
  double* parts = reduced_.data();
  for (int k = 0; k < rank_; ++k) parts[k] = dot(&lowerFactor_.q[at(0, k)], column, size_);
  for (int i = 0; i < size_; ++i) column[i] = 0;
  for (int k = 0; k < rank_; ++k) subtract(-parts[k], &lowerFactor_.q[at(0, k)], column, size_);
}

/// A column of which nothing is left gets the inverse length 0, on the diagonal of R, and so no part in solutions.
void MinimumNormSolver::orthogonalize(const std::vector<double>& columns, Orthogonal& factor) const {
  for (int k = 0; k < rank_; ++k) {
    double* column = &factor.q[at(0, k)];
    const double* source = &columns[at(0, k)];
    for (int i = 0; i < size_; ++i) column[i] = source[i];
    double taken = 0;
    for (int j = 0; j < k; ++j) {
      const double part = dot(&factor.q[at(0, j)], column, size_);
      factor.r[at(j, k)] = part;
      taken += part * part;
      subtract(part, &factor.q[at(0, j)], column, size_);
    }
    const double left = dot(column, column, size_);
    const double inverse = left > kVanished * kVanished * taken ? 1 / std::sqrt(left) : 0;
    factor.r[at(k, k)] = inverse;
    for (int i = 0; i < size_; ++i) column[i] *= inverse;
  }
}

// One refinement takes out what the rounding of nearly dependent rows leaves.
void MinimumNormSolver::solve(double* x) {
  if (isWellConditioned_) return solveOnce(x);
  for (int row = 0; row < size_; ++row) residual_[static_cast<std::size_t>(row)] = x[row];
  solveOnce(x);
  const std::vector<double>& matrix = isCoupled_ ? coupled_ : symmetric_;
  for (int column = 0; column < size_; ++column) subtract(x[column], &matrix[at(0, column)], residual_.data(), size_);
  solveOnce(residual_.data());
  for (int row = 0; row < size_; ++row) x[row] += residual_[static_cast<std::size_t>(row)];
}

void MinimumNormSolver::solveOnce(double* x) {
  reduce(x);
  if (isCoupled_ || rank_ < size_)
    expand(x);
  else
    substituteBack(x);
}

/// y of L y = b, into reduced_.
void MinimumNormSolver::reduce(const double* b) {
  double* y = reduced_.data();
  if (rank_ == size_) {
    for (int k = 0; k < rank_; ++k) {
      const int pivot = pivots_[static_cast<std::size_t>(k)];
      double value = b[pivot];
      for (int j = 0; j < k; ++j) value -= lower_[at(pivot, j)] * y[j];
      y[k] = value * inverseBegin_[static_cast<std::size_t>(k)];
    }
    return;
  }
  for (int k = 0; k < rank_; ++k) y[k] = dot(&lowerFactor_.q[at(0, k)], b, size_);
  for (int k = rank_; k-- > 0;) {
    for (int j = k + 1; j < rank_; ++j) y[k] -= lowerFactor_.r[at(k, j)] * y[j];
    y[k] *= lowerFactor_.r[at(k, k)];
  }
}

/// The shortest x with K x = reduced_, or L^T x without C.
void MinimumNormSolver::expand(double* x) {
  const Orthogonal& factor = isCoupled_ ? upperFactor_ : lowerFactor_;
  double* z = reduced_.data();
  for (int i = 0; i < size_; ++i) x[i] = 0;
  for (int k = 0; k < rank_; ++k) {
    for (int j = 0; j < k; ++j) z[k] -= factor.r[at(j, k)] * z[j];
    z[k] *= factor.r[at(k, k)];
    subtract(-z[k], &factor.q[at(0, k)], x, size_);
  }
}

/// x of L^T x = reduced_.
void MinimumNormSolver::substituteBack(double* x) {
  for (int k = rank_; k-- > 0;) {
    double value = reduced_[static_cast<std::size_t>(k)];
    for (int j = k + 1; j < rank_; ++j) {
      const int pivot = pivots_[static_cast<std::size_t>(j)];
      value -= lower_[at(pivot, k)] * x[pivot];
    }
    x[pivots_[static_cast<std::size_t>(k)]] = value * inverseBegin_[static_cast<std::size_t>(k)];
  }
}

}  // namespace cradle
