#include "math/box_quadratic.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <vector>

namespace cradle {
namespace {

constexpr double kDependent = 1e-9;  // of the largest pivot: rows that differ by less depend on each other
constexpr double kRounding = 1e-12;  // of what a gradient is summed from: a smaller one is zero
// The same, for one that dependent rows leave: it is where they contradict each other.
constexpr double kContradiction = 1e-8;

/// Which numbers are at a limit: -1, 1, or 0 for those that are free.
using Active = std::vector<int>;

/// The minimum over the numbers that are free, the others being as they are.
VectorX freeMinimum(const MatrixX& A, const VectorX& b, const VectorX& x, const Active& active) {
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < active.size(); ++i)
    if (active[i] == 0) free.push_back(static_cast<Eigen::Index>(i));
  VectorX found = x;
  if (free.empty()) return found;
  for (const Eigen::Index i : free) found[i] = 0;
  const VectorX side = (b - A * found)(free);
  Eigen::CompleteOrthogonalDecomposition<MatrixX> decomposition;
  decomposition.setThreshold(kDependent);
  const VectorX part = decomposition.compute(A(free, free)).solve(side);
  for (std::size_t k = 0; k < free.size(); ++k) found[free[k]] = part[static_cast<Eigen::Index>(k)];
  return found;
}

/// The sizes of the terms of the gradient A x - b.
VectorX gradientScale(const MatrixX& A, const VectorX& b, const VectorX& x) {
  return A.cwiseAbs() * x.cwiseAbs() + b.cwiseAbs();
}

/// Against the gradient at `stationary` of the numbers that are free, which dependent rows of A leave there; zero if it
/// is rounding.
VectorX contradictionAt(const MatrixX& A, const VectorX& b, const VectorX& stationary, const Active& active,
                        double rounding) {
  VectorX left = b - A * stationary;
  for (std::size_t i = 0; i < active.size(); ++i)
    if (active[i] != 0) left[static_cast<Eigen::Index>(i)] = 0;
  const double most = std::max(rounding, kContradiction * gradientScale(A, b, stationary).maxCoeff());
  return left.cwiseAbs().maxCoeff() > most ? left : VectorX(VectorX::Zero(left.size()));
}

/// Where to go from `x`: to the minimum over the numbers that are free. Where x^T A x / 2 - b^T x falls without end, as
/// far as limits let it: along what dependent rows leave of the gradient, or, where it is greatest on the line to the
/// stationary point, on the other side of `x`.
VectorX aimFrom(const MatrixX& A, const VectorX& b, const VectorX& x, const Active& active, const VectorX& limits,
                double rounding) {
  const VectorX stationary = freeMinimum(A, b, x, active);
  VectorX way = contradictionAt(A, b, stationary, active, rounding);
  if (way.isZero(0)) {
    way = x - stationary;
    const VectorX size = way.cwiseAbs();
    if (way.dot(A * way) >= -kRounding * size.dot(A.cwiseAbs() * size)) return stationary;
  }
  double far = 0;
  for (Eigen::Index i = 0; i < way.size(); ++i)
    if (way[i] != 0) far = std::max(far, 2 * limits[i] / std::abs(way[i]));
  return x + 2 * far * way;
}

/// Goes from `x` towards `aim` as far as limits let it; where one stops it, that is active from then on. True if none
/// does.
bool approach(const VectorX& aim, const VectorX& limits, VectorX& x, Active& active) {
  double most = 1;
  std::size_t blocking = active.size();
  for (std::size_t i = 0; i < active.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (active[i] != 0 || std::abs(aim[at]) <= limits[at]) continue;
    const double part = (std::copysign(limits[at], aim[at]) - x[at]) / (aim[at] - x[at]);
    if (part < most) most = std::max(0.0, part), blocking = i;
  }
  x += most * (aim - x);
  if (blocking == active.size()) return true;
  const auto at = static_cast<Eigen::Index>(blocking);
  active[blocking] = aim[at] < 0 ? -1 : 1;
  x[at] = active[blocking] * limits[at];
  return false;
}

/// Frees the number at a limit whose gradient points inwards most. False if there is none.
bool release(const MatrixX& A, const VectorX& b, const VectorX& limits, const VectorX& x, Active& active) {
  const VectorX gradient = A * x - b;
  const VectorX scale = gradientScale(A, b, x);
  double most = 0;
  std::size_t released = active.size();
  for (std::size_t i = 0; i < active.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double inwards = active[i] * gradient[at];
    if (active[i] == 0 || limits[at] == 0 || inwards <= kRounding * scale[at] || inwards <= most) continue;
    most = inwards, released = i;
  }
  if (released == active.size()) return false;
  active[released] = 0;
  return true;
}

/// Shares what dependent rows leave open with the numbers that came to a limit on the way and have nothing to do there:
/// x becomes the least such minimum, if it is within the limits.
void share(const MatrixX& A, const VectorX& b, const VectorX& limits, VectorX& x, Active active) {
  const VectorX gradient = A * x - b;
  const VectorX scale = gradientScale(A, b, x);
  bool isAny = false;
  for (std::size_t i = 0; i < active.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (active[i] == 0 || std::abs(gradient[at]) > kDependent * scale[at]) continue;
    active[i] = 0, isAny = true;
  }
  if (!isAny) return;
  const VectorX least = freeMinimum(A, b, x, active);
  if ((least.cwiseAbs().array() <= limits.array()).all()) x = least;
}

}  // namespace

VectorX boxMinimum(const MatrixX& A, const VectorX& b, const VectorX& limits, double rounding) {
  VectorX x = VectorX::Zero(b.size());
  Active active(static_cast<std::size_t>(b.size()), 0);
  const int most = 20 + 10 * static_cast<int>(b.size());  // more are cycles of a matrix that is not quite symmetric
  for (int change = 0; change < most; ++change)
    if (approach(aimFrom(A, b, x, active, limits, rounding), limits, x, active) && !release(A, b, limits, x, active))
      break;
  share(A, b, limits, x, active);
  return x;
}

}  // namespace cradle
