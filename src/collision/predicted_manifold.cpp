#include "collision/predicted_manifold.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cradle {
namespace {

// m farther apart than the deepest point: such points carry when bodies tilt a little. The smallest margin with which
// soft contacts are looked for (SoftParameters::kContactMargin): points beyond it are not known in any case.
constexpr double kMayCarry = 5e-3;

PredictedManifold single(const Vec3& normal, const Vec3& onA, const Vec3& onB) {
  PredictedManifold manifold;
  manifold.normal = normal;
  manifold.count = 1;
  manifold.points[0] = {onA, onB, normal.dot(onB - onA)};
  return manifold;
}

PredictedManifold none(double clearance) {
  PredictedManifold manifold;
  manifold.clearance = clearance;
  return manifold;
}

/// A box's surface as a point sees it.
struct NearestOfBox {
  double distance;  // m, < 0 inside
  Vec3 normal;      // unit, out of the box
  Vec3 point;       // m, world
};

NearestOfBox nearestOf(const PosedBox& box, const Vec3& from) {
  const Vec3 local = box.axes.transpose() * (from - box.center);
  const Vec3 nearest = local.cwiseMin(box.halfSize).cwiseMax(-box.halfSize);
  const double distance = (local - nearest).norm();
  if (distance > 0) return {distance, box.axes * ((local - nearest) / distance), box.center + box.axes * nearest};
  Eigen::Index axis = 0;
  const double depth = (box.halfSize - local.cwiseAbs()).minCoeff(&axis);
  const Vec3 normal = (local[axis] < 0 ? -1 : 1) * box.axes.col(axis);
  return {-depth, normal, from + depth * normal};
}

/// Appends the point of which `measure` is greatest, and returns where it is.
template <class Measure>
Vec3 appendGreatest(const PredictedManifold::Point* points, std::size_t count, const Measure& measure,
                    PredictedManifold& manifold) {
  std::size_t best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < count; ++k)
    if (const double value = measure(points[k]); value > most) most = value, best = k;
  manifold.points[manifold.count++] = points[best];
  return points[best].onA;
}

/// Appends four of those that are eligible: the deepest, the farthest from it, and the farthest on either side of both.
template <class IsEligible>
void appendLargest(const PredictedManifold::Point* points, std::size_t count, const IsEligible& isEligible,
                   PredictedManifold& manifold) {
  const auto append = [&](const auto& measure) {
    return appendGreatest(
        points, count,
        [&](const PredictedManifold::Point& p) {
          return isEligible(p) ? measure(p) : -std::numeric_limits<double>::infinity();
        },
        manifold);
  };
  const Vec3 first = append([](const PredictedManifold::Point& p) { return -p.separation; });
  const Vec3 second = append([&](const PredictedManifold::Point& p) { return (p.onA - first).squaredNorm(); });
  const Vec3 across = manifold.normal.cross(second - first);
  const auto height = [&](const PredictedManifold::Point& p) { return across.dot(p.onA - first); };
  append(height);
  append([&](const PredictedManifold::Point& p) { return -height(p); });
}

/// Appends the point that is farthest from those of the manifold.
void appendFarthest(const PredictedManifold::Point* points, std::size_t count, PredictedManifold& manifold) {
  const auto distance2 = [&](const PredictedManifold::Point& p) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < manifold.count; ++k)
      least = std::min(least, (p.onA - manifold.points[k].onA).squaredNorm());
    return least;
  };
  appendGreatest(points, count, distance2, manifold);
}

}  // namespace

/// Apart, the normal is that of the instant at which they meet: |offset + part motion| = reach.
PredictedManifold contactOfSpheres(const PosedSphere& a, const PosedSphere& b, const Vec3& motion, double margin) {
  Vec3 offset = b.center - a.center;
  const double reach = a.radius + b.radius, distance2 = offset.squaredNorm();
  if (distance2 > (reach + margin) * (reach + margin)) {
    const double along = offset.dot(motion), excess = distance2 - reach * reach;
    const double root = along * along - motion.squaredNorm() * excess;
    const double gap = std::sqrt(distance2) - reach;
    if (along >= 0 || root < 0) return none(gap);
    const double part = excess / (std::sqrt(root) - along);
    if (part > 1) return none(gap);
    offset += part * motion;
  }
  const double length = offset.norm();
  const Vec3 normal = length > 0 ? Vec3(offset / length) : Vec3(Vec3::UnitY());
  return single(normal, a.center + a.radius * normal, b.center - b.radius * normal);
}

/// Apart, the box is taken where it is when it has come as near as its speed along the normal of now allows.
PredictedManifold contactOfSphereAndBox(const PosedSphere& a, const PosedBox& b, const Vec3& motion, double margin) {
  NearestOfBox nearest = nearestOf(b, a.center);
  const double gap = nearest.distance - a.radius;
  if (gap - motion.norm() > margin) return none(gap);
  const double closing = nearest.normal.dot(motion);
  if (gap > margin) {
    if (closing <= 0) return none(gap);
    nearest = nearestOf(b, a.center - std::min(1.0, gap / closing) * motion);
    if (nearest.distance - a.radius > margin) return none(gap);
  }
  return single(-nearest.normal, a.center - a.radius * nearest.normal, nearest.point);
}

PredictedManifold contactOfSphereAndPlane(const PosedSphere& a, const PlaneCollider& b, const Vec3& motion,
                                          double margin) {
  const double height = b.normal.dot(a.center - b.point), closing = b.normal.dot(motion);
  if (height - a.radius - std::max(0.0, closing) > margin) return none(height - a.radius);
  return single(-b.normal, a.center - a.radius * b.normal, a.center - height * b.normal);
}

PredictedManifold contactOfBoxAndPlane(const PosedBox& a, const PlaneCollider& b, const Vec3& motion, double margin,
                                       double scale) {
  const double reach = margin + std::max(0.0, b.normal.dot(motion));
  const double middle = b.normal.dot(a.center - b.point);
  const Vec3 heights = (a.axes.transpose() * b.normal).cwiseProduct(a.halfSize);
  PredictedManifold manifold;
  manifold.normal = -b.normal;
  manifold.clearance = middle - heights.cwiseAbs().sum();
  if (manifold.clearance > reach) return manifold;
  PredictedManifold::Point points[8];
  std::size_t count = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 signs(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const double height = middle + heights.dot(signs);
    if (height > reach) continue;
    const Vec3 at = a.center + a.axes * signs.cwiseProduct(a.halfSize);
    points[count++] = {at, at - height * b.normal, height};
  }
  appendSpanning(points, count, manifold, scale);
  return manifold;
}

PredictedManifold exchanged(PredictedManifold manifold) {
  manifold.normal = -manifold.normal;
  for (PredictedManifold::Point& point : manifold.points) std::swap(point.onA, point.onB);
  return manifold;
}

/// Manifolds are kept while bodies tilt a little. If points that are pressed after the tilt were left out for others
/// that are farther away, bodies would fall on them, the next manifold would have them instead of others, and heaps
/// would tremble.
void appendSpanning(const PredictedManifold::Point* points, std::size_t count, PredictedManifold& manifold,
                    double scale) {
  if (count <= PredictedManifold::kMaxPoints) {
    for (std::size_t k = 0; k < count; ++k) manifold.points[manifold.count++] = points[k];
    return;
  }
  double deepest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < count; ++k) deepest = std::min(deepest, points[k].separation);
  const auto mayCarry = [&](const PredictedManifold::Point& p) { return p.separation < deepest + scale * kMayCarry; };
  if (std::count_if(points, points + count, mayCarry) > std::ssize(manifold.points)) {
    appendLargest(points, count, mayCarry, manifold);
    return;
  }
  for (std::size_t k = 0; k < count; ++k)
    if (mayCarry(points[k])) manifold.points[manifold.count++] = points[k];
  while (manifold.count < PredictedManifold::kMaxPoints) appendFarthest(points, count, manifold);
}

}  // namespace cradle
