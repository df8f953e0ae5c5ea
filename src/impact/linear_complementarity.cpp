// Principal pivoting for the linear complementarity problem (R. W. Cottle, J.-S. Pang, R. E. Stone, "The Linear
// Complementarity Problem", 1992, section 4.2). The solution lambda minimises
//   f(lambda) = lambda^T A lambda / 2 + b^T lambda over lambda >= 0,   (1)
// since A is symmetric. A row pushes if its lambda is > 0, and is satisfied if its residual (A lambda + b)_i is >= 0.
// One pivot drives the most violated row: its lambda grows, and those of the pushing rows change with it so that their
// residuals stay 0. Rows that were satisfied are not guarded meanwhile, as in C. L. Lawson, R. J. Hanson, "Solving
// Least Squares Problems", 1974, section 23.3. The minimum of f over the pushing rows falls with every pivot, so that
// no set of pushing rows comes back. Where A is singular along the direction of a pivot, the step ends at a row that
// stops pushing: the submatrix of A of the pushing rows is regular at all times.

#include "impact/linear_complementarity.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/error.h"

namespace cradle {
namespace {

using Index = Eigen::Index;

// Of the sum of the magnitudes in a row, for each of its terms: a violation by less is rounding.
constexpr double kRowRounding = 64 * std::numeric_limits<double>::epsilon();
// Of a diagonal element: elimination of other rows leaves rounding of up to 1e4 unit roundoffs of it.
constexpr double kEliminatedRatio = 1e-12;
constexpr int kMaxDirectRows = 8;       // of a problem that is first tried without pivots: its factors fit on the stack
constexpr long kMaxPivotsPerRow = 100;  // 1 or 2 are usual
// Of the diagonal elements, to which they are added, one after the other, where rounding lets sets of pushing rows come
// back: from ten times what elimination takes for rounding, in steps of 100.
constexpr double kDiagonalShifts[] = {1e-11, 1e-9, 1e-7};

class Pivoting {
 public:
  Pivoting(const MatrixX& a, const VectorX& b)
      : a_(a), b_(b), lambda_(VectorX::Zero(b.size())), isInfeasible_(static_cast<std::size_t>(b.size()), 0) {}

  /// The row that is violated most, by more than rounding; -1: none.
  Index mostViolated() const;
  /// Lets a row push until it is satisfied.
  void drive(Index row);
  const VectorX& lambda() const { return lambda_; }

 private:
  double residual(Index row) const { return b_[row] + a_.row(row).dot(lambda_); }
  VectorX solveForPushing(const VectorX& rightHandSide) const;
  VectorX direction(Index row) const;
  Index firstToStop(const VectorX& along) const;
  void stop(Index row);
  void satisfyPushing();

  const MatrixX& a_;
  const VectorX& b_;
  VectorX lambda_;
  std::vector<Index> pushing_;      // rows with lambda > 0, whose residual is 0
  std::vector<char> isInfeasible_;  // by row: no lambda satisfies it
};

Index Pivoting::mostViolated() const {
  Index most = -1;
  double largest = 0;
  for (Index row = 0; row < b_.size(); ++row) {
    if (lambda_[row] > 0 || isInfeasible_[static_cast<std::size_t>(row)]) continue;
    const double terms = std::abs(b_[row]) + a_.row(row).cwiseAbs().dot(lambda_);
    const double violation = -residual(row);
    if (violation <= std::max(largest, kRowRounding * static_cast<double>(b_.size()) * terms)) continue;
    most = row, largest = violation;
  }
  return most;
}

/// The vector x with A x = rightHandSide in the pushing rows, and x = 0 in all others.
VectorX Pivoting::solveForPushing(const VectorX& rightHandSide) const {
  VectorX x = VectorX::Zero(b_.size());
  if (pushing_.empty()) return x;
  const MatrixX a = a_(pushing_, pushing_);
  const VectorX pushes = rightHandSide(pushing_);
  x(pushing_) = VectorX(a.ldlt().solve(pushes));
  return x;
}

/// The direction of a pivot: the change of lambda for a unit change of the row's own that keeps the residuals of the
/// pushing rows.
VectorX Pivoting::direction(Index row) const {
  VectorX along = solveForPushing(-a_.col(row));
  along[row] = 1;
  return along;
}

/// The pushing row whose lambda reaches zero first along a direction; -1: none does.
Index Pivoting::firstToStop(const VectorX& along) const {
  Index first = -1;
  for (const Index row : pushing_)
    if (along[row] < 0 && (first < 0 || lambda_[row] * along[first] > lambda_[first] * along[row])) first = row;
  return first;
}

void Pivoting::drive(Index row) {
  const VectorX lambdaBefore = lambda_;
  const std::vector<Index> pushingBefore = pushing_;
  while (true) {
    const VectorX along = direction(row);
    const double curvature = a_.row(row).dot(along);
    const bool isSingular = curvature <= kEliminatedRatio * a_(row, row);
    const Index first = firstToStop(along);
    const double furthest = first < 0 ? INFINITY : -lambda_[first] / along[first];
    const double wanted = isSingular ? INFINITY : std::max(0.0, -residual(row) / curvature);
    if (wanted == INFINITY && furthest == INFINITY) {
      lambda_ = lambdaBefore, pushing_ = pushingBefore;
      isInfeasible_[static_cast<std::size_t>(row)] = 1;
      return;
    }
    lambda_ += std::min(wanted, furthest) * along;
    if (wanted <= furthest) break;
    stop(first);
  }
  pushing_.push_back(row);
  satisfyPushing();
}

void Pivoting::stop(Index row) {
  lambda_[row] = 0;
  std::erase(pushing_, row);
}

/// Computes lambda of the pushing rows from `b` alone, so that errors of the pivots' steps do not add up. Rows that
/// reached zero in the same step as the one that ended it stop pushing.
void Pivoting::satisfyPushing() {
  while (true) {
    lambda_ = solveForPushing(-b_);
    const auto none = [this](Index row) { return lambda_[row] <= 0; };
    if (std::none_of(pushing_.begin(), pushing_.end(), none)) return;
    std::erase_if(pushing_, none);
  }
}

bool areUncoupled(const MatrixX& a) {
  for (Index column = 0; column < a.cols(); ++column)
    for (Index row = 0; row < column; ++row)
      if (a(row, column) != 0) return false;
  return true;
}

VectorX solveUncoupled(const MatrixX& a, const VectorX& b) {
  VectorX lambda(b.size());
  for (Index row = 0; row < b.size(); ++row) lambda[row] = a(row, row) > 0 ? std::max(0.0, -b[row] / a(row, row)) : 0.0;
  return lambda;
}

/// The solution for few rows if all of them push, as they mostly do: one factorisation, no pivots. None if a row does
/// not push, or if A is singular.
std::optional<VectorX> solveForAll(const MatrixX& a, const VectorX& b) {
  if (b.size() > kMaxDirectRows) return std::nullopt;
  using Few = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxDirectRows, kMaxDirectRows>;
  const Eigen::LLT<Few> factor{Few(a)};
  if (factor.info() != Eigen::Success) return std::nullopt;
  for (Index row = 0; row < b.size(); ++row)
    if (!(factor.matrixLLT()(row, row) * factor.matrixLLT()(row, row) > kEliminatedRatio * a(row, row)))
      return std::nullopt;
  VectorX lambda = factor.solve(-b);
  if (!(lambda.minCoeff() > 0)) return std::nullopt;
  return lambda;
}

/// The solution by pivots. None if there are too many pivots: rounding then lets sets of pushing rows come back.
std::optional<VectorX> solveByPivots(const MatrixX& a, const VectorX& b) {
  Pivoting pivoting(a, b);
  const long most = kMaxPivotsPerRow * static_cast<long>(b.size());
  for (long pivots = 0; pivots <= most; ++pivots) {
    const Index row = pivoting.mostViolated();
    if (row < 0) return pivoting.lambda();
    pivoting.drive(row);
  }
  return std::nullopt;
}

}  // namespace

VectorX solveLinearComplementarity(const MatrixX& a, const VectorX& b) {
  if (areUncoupled(a)) return solveUncoupled(a, b);
  if (const auto lambda = solveForAll(a, b)) return *lambda;
  if (const auto lambda = solveByPivots(a, b)) return *lambda;
  for (const double ratio : kDiagonalShifts) {
    MatrixX regular = a;
    regular.diagonal() *= 1 + ratio;
    if (const auto lambda = solveByPivots(regular, b)) return *lambda;
  }
  throw Error(ErrorKind::unstable, "",
              "the forces among " + std::to_string(b.size()) + " contacts cannot be found: rounding hides them");
}

}  // namespace cradle
