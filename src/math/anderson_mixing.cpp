#include "math/anderson_mixing.h"

#include <Eigen/QR>

namespace cradle {
namespace {

constexpr std::size_t kMaxPoints = 9;  // kept: eight differences
constexpr double kRankRatio = 1e-12;   // of the largest pivot of differences: less is rounding

}  // namespace

VectorX AndersonMixing::next(const VectorX& x, const VectorX& image) {
  if (points_.size() == kMaxPoints) points_.erase(points_.begin()), steps_.erase(steps_.begin());
  points_.push_back(x), steps_.push_back(image - x);
  const auto count = static_cast<Eigen::Index>(points_.size()) - 1;
  if (count == 0) return image;
  // The weights w for which the step at x - dX w is shortest, if f is linear: dF w = f(x) - x.
  MatrixX pointChanges(x.size(), count), stepChanges(x.size(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto earlier = static_cast<std::size_t>(i);
    pointChanges.col(i) = x - points_[earlier];
    stepChanges.col(i) = steps_.back() - steps_[earlier];
  }
  Eigen::ColPivHouseholderQR<MatrixX> factor(stepChanges);
  factor.setThreshold(kRankRatio);
  // Its own solution has no threshold, and divides by zero where f(x) - x stays the same.
  const Eigen::Index rank = factor.rank();
  VectorX turned = steps_.back(), weights = VectorX::Zero(count);
  turned.applyOnTheLeft(factor.householderQ().setLength(rank).adjoint());
  VectorX known = turned.head(rank);
  factor.matrixQR().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().solveInPlace(known);
  weights(factor.colsPermutation().indices().head(rank)) = known;
  return image - (pointChanges + stepChanges) * weights;
}

}  // namespace cradle
