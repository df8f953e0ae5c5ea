// Cells of the size of the spheres' spacing: D. C. Rapaport, "The event scheduling problem in molecular dynamic
// simulation", J. Comput. Phys. 34, 1980.

#include "simulate/spheres/sphere_cells.h"

#include <algorithm>
#include <cmath>

#include "math/elementary.h"

namespace cradle {
namespace {

constexpr int kNoSphere = -1;
constexpr std::size_t kFewThings = 16;  // so few things are tested faster than 27 cells are visited
constexpr double kCellMargin = 1e-6;    // of a cell: what touches within rounding is near
constexpr long kMinCount = 4;           // along an axis, so that a cell and its two neighbours are three lists
constexpr long kMaxLists = 8;           // a sphere

/// The smallest power of two >= `least`, not below kMinCount.
long powerOfTwo(double least) {
  long power = kMinCount;
  while (static_cast<double>(power) < least && power < (1L << 20)) power *= 2;
  return power;
}

}  // namespace

SphereCells::SphereCells(const std::vector<Vec3>& centers, double largestRadius, std::size_t fixed) {
  if (centers.size() + fixed > kFewThings) {
    Bounds bounds;
    for (const Vec3& center : centers) bounds.extend(center);
    origin_ = bounds.min();
    const double smallest = 2 * largestRadius * (1 + kCellMargin);
    const Vec3 extent = bounds.sizes().cwiseMax(smallest);
    const double spacing = exp(log(extent.prod() / static_cast<double>(centers.size())) / 3);
    size_ = std::max(smallest, spacing);
    for (std::size_t axis = 0; axis < 3; ++axis)
      counts_[axis] = powerOfTwo(extent[static_cast<Eigen::Index>(axis)] / size_);
    while (counts_[0] * counts_[1] * counts_[2] > kMaxLists * static_cast<long>(centers.size())) {
      long& most = *std::max_element(counts_.begin(), counts_.end());
      if (most == kMinCount) break;
      most /= 2;
    }
  }
  const auto lists = static_cast<std::size_t>(counts_[0] * counts_[1] * counts_[2]);
  first_.assign(lists, kNoSphere);
  fixed_.resize(lists);
  next_.assign(centers.size(), kNoSphere);
  before_.assign(centers.size(), kNoSphere);
  for (const Vec3& center : centers) cells_.push_back(cellAt(center));
  for (int sphere = 0; sphere < std::ssize(centers); ++sphere) insert(sphere);
}

Cell SphereCells::cellAt(const Vec3& center) const {
  if (!isBounded()) return {0, 0, 0};
  Cell cell;
  for (int axis = 0; axis < 3; ++axis)
    cell[static_cast<std::size_t>(axis)] = static_cast<long>(std::floor((center[axis] - origin_[axis]) / size_));
  return cell;
}

void SphereCells::insert(int sphere) {
  const auto index = static_cast<std::size_t>(sphere);
  int& first = first_[listOf(cells_[index])];
  next_[index] = first, before_[index] = kNoSphere;
  if (first != kNoSphere) before_[static_cast<std::size_t>(first)] = sphere;
  first = sphere;
}

void SphereCells::move(int sphere, int axis, int step) {
  const auto index = static_cast<std::size_t>(sphere);
  const int next = next_[index], before = before_[index];
  if (next != kNoSphere) before_[static_cast<std::size_t>(next)] = before;
  (before != kNoSphere ? next_[static_cast<std::size_t>(before)] : first_[listOf(cells_[index])]) = next;
  cells_[index][static_cast<std::size_t>(axis)] += step;
  insert(sphere);
}

void SphereCells::addFixed(int fixed, const Bounds& bounds) {
  Cell from = {0, 0, 0}, to = {0, 0, 0};
  for (std::size_t axis = 0; axis < 3 && isBounded(); ++axis) {
    const auto along = static_cast<Eigen::Index>(axis);
    const double low = std::floor((bounds.min()[along] - origin_[along]) / size_ - kCellMargin);
    const double high = std::floor((bounds.max()[along] - origin_[along]) / size_ + kCellMargin);
    from[axis] = high - low + 1 < static_cast<double>(counts_[axis]) ? static_cast<long>(low) : 0;
    to[axis] = from[axis] + static_cast<long>(std::min(high - low, static_cast<double>(counts_[axis] - 1)));
  }
  for (long x = from[0]; x <= to[0]; ++x)
    for (long y = from[1]; y <= to[1]; ++y)
      for (long z = from[2]; z <= to[2]; ++z) fixed_[listOf({x, y, z})].push_back(fixed);
}

}  // namespace cradle
