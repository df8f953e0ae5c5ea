#include "collision/broad_phase.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "collision/feature_neighbour_list.h"
#include "collision/mesh_collider.h"
#include "collision/separation.h"
#include "core/error.h"

namespace cradle {
namespace {

constexpr double kSlackMotions = 4;  // steps like the one to come that a list should last
constexpr double kMinSlack = 0.05;   // of a body's size: bodies that are nearly still are not sorted again at each step
constexpr double kMaxSlack = 0.25;   // of the size: beyond, lists of pairs that are not near cost more than new ones
constexpr double kDeflection = 0.25;  // of its displacement: a body may be turned aside by as much without a new list
constexpr double kCellWidth = 1.5;    // of the mean size of the moving bodies' boxes
// From the middle: boxes farther away share the outermost cells; a row is shorter than kRow.
constexpr double kMaxCells = 1e9;
// Boxes that a thread takes at once: few enough to balance threads, many enough that they seldom wait for each other.
constexpr std::size_t kComparedBoxes = 256;
// Of the coordinates: 1e4 unit roundoffs, far more than the few of a rotated box.
constexpr double kBoxRounding = 1e-12;
constexpr double kMaxMotion = 1e100;  // m: keeps sums finite; a step that has blown up is judged elsewhere

/// The box around a body's box that is turned.
Bounds turnedBounds(const Bounds& bounds, const RigidTransform& worldFromBody) {
  const Mat3 rotation = worldFromBody.rotation.toRotationMatrix();
  const Vec3 center = rotation * bounds.center() + worldFromBody.translation;
  const Vec3 half = rotation.cwiseAbs() * (bounds.sizes() / 2);
  return {Vec3(center - half), Vec3(center + half)};
}

/// Bound on how far (m) turning from one orientation to another moves a point at `radius` (m): a chord c of the unit
/// quaternions turns points by an angle a with c = 2 sin(a/4), and 2 r sin(a/2) <= 2 r c.
double rotationDisplacement(const Quat& from, const Quat& to, double radius) {
  return 2 * radius * std::min((from.coeffs() - to.coeffs()).norm(), (from.coeffs() + to.coeffs()).norm());
}

/// The box that a point sweeps along the displacement `drift` (m), and `around` (m) it.
Bounds sweptBounds(const Vec3& from, const Vec3& drift, double around) {
  const Vec3 to = from + drift, grown = Vec3::Constant(around);
  return {Vec3(from.cwiseMin(to) - grown), Vec3(from.cwiseMax(to) + grown)};
}

bool isCenteredSphere(const Collider& collider) {
  return collider.isSphere() && collider.points[0].isZero();
}

bool isExcluded(const ContactGeometry& geometry, std::size_t a, std::size_t b) {
  return std::binary_search(geometry.excluded.begin(), geometry.excluded.end(), std::pair(a, b));
}

/// Cells side by side across the sweep, in rows: cells next to each other in a row have numbers that follow each other.
constexpr std::int64_t kRow = std::int64_t{1} << 31;

std::int64_t cellOf(double across, double third) {
  const auto whole = [](double cells) {
    return static_cast<std::int64_t>(std::floor(std::clamp(cells, -kMaxCells, kMaxCells)));
  };
  return whole(across) * kRow + whole(third);
}

/// Height of a box's lowest point over a plane.
double lowest(const Bounds& box, const PlaneCollider& plane) {
  return plane.normal.dot(box.center() - plane.point) - plane.normal.cwiseAbs().dot(box.sizes() / 2);
}

}  // namespace

bool BroadPhase::update(const VectorX& state, const std::vector<double>& motions, double margin,
                        ContactGeometry& geometry) {
  return update({state, motions, {}}, margin, geometry);
}

bool BroadPhase::update(const PredictedMotion& predicted, double margin, ContactGeometry& geometry) {
  if (geometry.colliders.empty() || covers(predicted, margin)) return false;
  enclose(predicted, margin, geometry);
  sort(geometry);
  sweep(geometry);
  return true;
}

Vec3 BroadPhase::displacementOf(const PredictedMotion& predicted, std::size_t body) {
  return predicted.displacements.empty() ? Vec3(Vec3::Zero()) : predicted.displacements[body];
}

bool BroadPhase::covers(const PredictedMotion& predicted, double margin) const {
  if (poses_.empty()) return false;
  for (std::size_t body = 0; body < predicted.motions.size(); ++body) {
    const RigidTransform now = poseOf(predicted.state, static_cast<int>(body));
    const double turning =
        spinRadii_[body] > 0 ? rotationDisplacement(poses_[body].rotation, now.rotation, spinRadii_[body]) : 0;
    const double around = turning + predicted.motions[body] + margin;
    // Not a number is not covered.
    if (!(around <= margins_[body])) return false;
    if (!centers_[body].contains(sweptBounds(now.translation, displacementOf(predicted, body), around))) return false;
  }
  return true;
}

void BroadPhase::enclose(const PredictedMotion& predicted, double margin, const ContactGeometry& geometry) {
  const std::size_t count = predicted.motions.size();
  radii_.assign(count, 0.0), spinRadii_.assign(count, 0.0);
  for (const Collider& collider : geometry.colliders)
    if (collider.body != kFixed) {
      const auto body = static_cast<std::size_t>(collider.body);
      radii_[body] = collider.boundingRadius;
      spinRadii_[body] = isCenteredSphere(collider) ? 0 : collider.boundingRadius;
    }
  poses_.clear(), margins_.clear(), centers_.clear();
  for (std::size_t body = 0; body < count; ++body) {
    const Vec3 drift = predicted.ahead * displacementOf(predicted, body);
    const double aside = predicted.ahead * predicted.motions[body];
    const double motion = aside < kMaxMotion ? aside : kMaxMotion, way = drift.norm();
    const double ahead = std::min(kSlackMotions * (motion + way), kMaxSlack * radii_[body]);
    poses_.push_back(poseOf(predicted.state, static_cast<int>(body)));
    margins_.push_back(margin + std::max({motion + kDeflection * way, ahead, kMinSlack * radii_[body]}));
    centers_.push_back(sweptBounds(poses_.back().translation, drift, margins_.back()));
  }
  encloseColliders(geometry, predicted);
}

void BroadPhase::encloseColliders(const ContactGeometry& geometry, const PredictedMotion& predicted) {
  boxes_.clear(), roundings_.clear();
  for (const Collider& collider : geometry.colliders) {
    const auto body = static_cast<std::size_t>(collider.body);
    Bounds box = collider.body == kFixed ? collider.bounds : turnedBounds(collider.bounds, poses_[body]);
    double grown = kBoxRounding * (box.min().cwiseAbs() + box.max().cwiseAbs()).maxCoeff();
    Vec3 drift = Vec3::Zero();
    if (collider.body != kFixed) grown += margins_[body], drift = predicted.ahead * displacementOf(predicted, body);
    boxes_.emplace_back(Vec3(box.min() + drift.cwiseMin(0) - Vec3::Constant(grown)),
                        Vec3(box.max() + drift.cwiseMax(0) + Vec3::Constant(grown)));
    roundings_.push_back(collider.isSphere() ? collider.radius + grown : 0);
  }
}

/// Cells along the axis on which the boxes spread the most, side by side along the others. Boxes wider than a cell are
/// compared with all others.
void BroadPhase::sort(const ContactGeometry& geometry) {
  Vec3 mean = Vec3::Zero(), spread = Vec3::Zero();
  for (const Bounds& box : boxes_) mean += box.center() / static_cast<double>(boxes_.size());
  for (const Bounds& box : boxes_) spread += (box.center() - mean).cwiseAbs2();
  Eigen::Index along = 0;
  spread.maxCoeff(&along);
  const Eigen::Index across = (along + 1) % 3, third = (along + 2) % 3;
  double width = 0;
  for (std::size_t i = 0; i < boxes_.size(); ++i)
    if (geometry.colliders[i].body != kFixed)
      width += kCellWidth * std::max(boxes_[i].sizes()[across], boxes_[i].sizes()[third]);
  width /= static_cast<double>(std::max<std::size_t>(1, poses_.size()));
  intervals_.clear(), wide_.clear();
  longest_ = 0;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const Vec3 least = boxes_[i].min(), most = boxes_[i].max();
    if (!(most[across] - least[across] <= width && most[third] - least[third] <= width)) {
      wide_.push_back(i);
      continue;
    }
    intervals_.push_back({cellOf((least[across] - mean[across]) / width, (least[third] - mean[third]) / width),
                          least[along], most[along], least[across], most[across], least[third], most[third], i});
    longest_ = std::max(longest_, most[along] - least[along]);
  }
  std::sort(intervals_.begin(), intervals_.end(), [](const Interval& a, const Interval& b) {
    return std::tie(a.cell, a.from, a.collider) < std::tie(b.cell, b.from, b.collider);
  });
}

void BroadPhase::compare(const ContactGeometry& geometry, std::size_t first, std::size_t second, Found& found) const {
  if (!boxes_[first].intersects(boxes_[second])) return;
  const std::size_t a = std::min(first, second), b = std::max(first, second);
  const Collider &colliderA = geometry.colliders[a], &colliderB = geometry.colliders[b];
  if (colliderA.isHeld() && colliderB.isHeld()) return;
  if (colliderA.isSphere() && colliderB.isSphere()) {
    // The gap between the boxes that the spheres' centres sweep, against the sum of their radii and margins.
    const double reach = roundings_[a] + roundings_[b];
    const Vec3 beside = (boxes_[b].center() - boxes_[a].center()).cwiseAbs() -
                        (boxes_[a].sizes() + boxes_[b].sizes()) / 2 + Vec3::Constant(reach);
    if (beside.cwiseMax(0).squaredNorm() > reach * reach) return;
  }
  if (geometry.excluded.empty() || !isExcluded(geometry, a, b)) found.emplace_back(a, b);
}

/// Each box with those in its cell and in four of the eight around it: those of the others find it.
void BroadPhase::compareIntervals(const ContactGeometry& geometry, std::size_t first, std::size_t last,
                                  Found& found) const {
  const auto meetAcross = [](const Interval& a, const Interval& b) {
    return a.thirdFrom <= b.thirdTo && b.thirdFrom <= a.thirdTo && a.acrossFrom <= b.acrossTo &&
           b.acrossFrom <= a.acrossTo;
  };
  const std::size_t count = intervals_.size();
  constexpr std::int64_t kAround[] = {1, kRow - 1, kRow, kRow + 1};
  std::size_t nexts[] = {0, 0, 0, 0};  // the first interval of those cells that may begin beside this one
  if (first < last)
    for (int k = 0; k < 4; ++k) {
      const std::int64_t cell = intervals_[first].cell + kAround[k];
      nexts[k] = static_cast<std::size_t>(
          std::partition_point(intervals_.begin(), intervals_.end(),
                               [&](const Interval& interval) { return interval.cell < cell; }) -
          intervals_.begin());
    }
  for (std::size_t i = first; i < last && found.size() <= kMaxPairs; ++i) {
    const Interval& here = intervals_[i];
    const auto compareFrom = [&](std::size_t from, std::int64_t cell) {
      for (std::size_t j = from; j < count && intervals_[j].cell == cell && intervals_[j].from <= here.to; ++j)
        if (meetAcross(here, intervals_[j])) compare(geometry, here.collider, intervals_[j].collider, found);
    };
    compareFrom(i + 1, here.cell);
    for (int k = 0; k < 4; ++k) {
      const std::int64_t cell = here.cell + kAround[k];
      std::size_t& next = nexts[k];
      while (next < count && (intervals_[next].cell < cell ||
                              (intervals_[next].cell == cell && intervals_[next].from < here.from - longest_)))
        ++next;
      compareFrom(next, cell);
    }
  }
}

void BroadPhase::compareWide(const ContactGeometry& geometry) {
  for (std::size_t i = 0; i < wide_.size() && found_[0].size() <= kMaxPairs; ++i) {
    for (const Interval& interval : intervals_) compare(geometry, wide_[i], interval.collider, found_[0]);
    for (std::size_t j = i + 1; j < wide_.size(); ++j) compare(geometry, wide_[i], wide_[j], found_[0]);
  }
}

/// Counting sort by the first collider, then the few of each by the second.
void BroadPhase::sortFound() {
  next_.assign(boxes_.size() + 1, 0);
  for (const Found& found : found_)
    for (const auto& [a, b] : found) ++next_[a + 1];
  for (std::size_t i = 1; i < next_.size(); ++i) next_[i] += next_[i - 1];
  if (next_.back() > kMaxPairs)
    throw Error(
        ErrorKind::limit, "",
        fmt::format("more than {} pairs of bodies are so near to each other that they may touch; at most {} are "
                    "simulated: take fewer bodies, or move those apart that are in one another",
                    kMaxPairs, kMaxPairs));
  sorted_.resize(next_.back());
  for (const Found& found : found_)
    for (const auto& pair : found) sorted_[next_[pair.first]++] = pair;
  std::size_t first = 0;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {  // next_[i] is the end of i's pairs now
    std::sort(sorted_.begin() + static_cast<std::ptrdiff_t>(first),
              sorted_.begin() + static_cast<std::ptrdiff_t>(next_[i]));
    first = next_[i];
  }
}

void BroadPhase::sweep(ContactGeometry& geometry) {
  const std::vector<ColliderPair> before = std::exchange(geometry.pairs, {});
  const auto material = [&](int surfaceA, int surfaceB) {
    return geometry.materials[static_cast<std::size_t>(surfaceA)][static_cast<std::size_t>(surfaceB)];
  };
  for (std::size_t p = 0; p < geometry.planes.size(); ++p)
    for (std::size_t i = 0; i < geometry.colliders.size(); ++i)
      if (!geometry.colliders[i].isHeld() && lowest(boxes_[i], geometry.planes[p]) <= 0)
        geometry.pairs.push_back({i, p, true, material(geometry.colliders[i].surface, geometry.planes[p].surface)});
  found_.resize(threads_ ? static_cast<std::size_t>(threads_->count()) : 1);
  for (Found& found : found_) found.clear();
  if (threads_)
    threads_->share(intervals_.size(), kComparedBoxes, [&](int thread, std::size_t first, std::size_t last) {
      compareIntervals(geometry, first, last, found_[static_cast<std::size_t>(thread)]);
    });
  else
    compareIntervals(geometry, 0, intervals_.size(), found_[0]);
  compareWide(geometry);
  sortFound();
  for (const auto& [a, b] : sorted_)
    geometry.pairs.push_back({a, b, false, material(geometry.colliders[a].surface, geometry.colliders[b].surface)});
  keepNeighbourLists(before, geometry);
}

/// Gives pairs of two surfaces the neighbour lists that they had in the list before, or new ones.
void BroadPhase::keepNeighbourLists(const std::vector<ColliderPair>& before, ContactGeometry& geometry) {
  const auto key = [](const ColliderPair& pair) { return std::tuple(!pair.againstPlane, pair.a, pair.b); };
  auto old = before.begin();
  for (ColliderPair& pair : geometry.pairs) {
    if (pair.againstPlane) continue;
    const Collider &a = geometry.colliders[pair.a], &b = geometry.colliders[pair.b];
    if (!hasMesh(a, b) || !a.mesh || !b.mesh) continue;
    while (old != before.end() && key(*old) < key(pair)) ++old;
    const bool isKept = old != before.end() && key(*old) == key(pair);
    pair.near = isKept ? old->near : std::make_shared<FeatureNeighbourList>();
  }
}

}  // namespace cradle
