// GJK: E. G. Gilbert, D. W. Johnson, S. S. Keerthi, "A fast procedure for computing the distance between complex
// objects in three-dimensional space", IEEE J. Robotics and Automation 4(2), 1988. The point v of the Minkowski
// difference A - B nearest to the origin is approached by simplices of its support points. With the support point w
// along -v, the distance d is bounded by
//   v . w / |v| <= d <= |v|.   (1)
// Nearest points of simplices come from their Voronoi regions: C. Ericson, "Real-Time Collision Detection", 2004, 5.1.

#include "collision/gjk.h"

#include <array>
#include <cmath>

#include "collision/convex_tolerances.h"

namespace cradle {
namespace {

// 10 to 40 are usual; with 30, separations of convex shapes that pass through 0 jump
constexpr int kMaxSimplexRounds = 60;
// Of the largest coordinate: 4 unit roundoffs, for a difference of points.
constexpr double kCoordinateRounding = 4e-16;

/// A point of A - B, and the points of A and B of which it is the difference.
struct Difference {
  Vec3 point, onA, onB;
};

/// Up to four of them, and the weights of the simplex's point nearest to the origin.
struct Simplex {
  std::array<Difference, 4> corners;
  std::array<double, 4> weights{1, 0, 0, 0};
  std::size_t count = 0;

  Vec3 nearest(Vec3 Difference::*part) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) sum += weights[i] * (corners[i].*part);
    return sum;
  }
  /// Drops corners without weight.
  void reduce() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (weights[i] <= 0) continue;
      corners[kept] = corners[i], weights[kept] = weights[i];
      ++kept;
    }
    count = kept;
  }
};

using Weights = std::array<double, 3>;

Weights nearestOnSegment(const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double part = -a.dot(along), whole = along.squaredNorm();
  if (part <= 0 || whole <= 0) return {1, 0, 0};
  if (part >= whole) return {0, 1, 0};
  return {1 - part / whole, part / whole, 0};
}

Weights nearestOnTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double part = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {0, 1 - part, part};
  }
  const double sum = va + vb + vc;
  return {va / sum, vb / sum, vc / sum};
}

/// Whether the origin is on the other side of the plane a b c than d, or in it.
bool isBeyond(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 normal = (b - a).cross(c - a);
  return -normal.dot(a) * normal.dot(d - a) <= 0;
}

/// The best of the faces that see the origin. False if none does: the origin is inside.
bool findNearestOnTetrahedron(Simplex& simplex) {
  constexpr std::array<std::array<std::size_t, 4>, 4> kFaces{{{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}}};
  const auto point = [&](std::size_t i) -> const Vec3& { return simplex.corners[i].point; };
  double least = std::numeric_limits<double>::infinity();
  std::array<double, 4> best{};
  for (const auto& [i, j, k, other] : kFaces) {
    if (!isBeyond(point(i), point(j), point(k), point(other))) continue;
    const Weights weights = nearestOnTriangle(point(i), point(j), point(k));
    const double distance = (weights[0] * point(i) + weights[1] * point(j) + weights[2] * point(k)).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best = {};
    best[i] = weights[0], best[j] = weights[1], best[k] = weights[2];
  }
  simplex.weights = best;
  return std::isfinite(least);
}

/// Sets the weights. False if the origin is inside.
bool findNearest(Simplex& simplex) {
  const auto& corners = simplex.corners;
  Weights weights{1, 0, 0};
  if (simplex.count == 4) return findNearestOnTetrahedron(simplex);
  if (simplex.count == 2) weights = nearestOnSegment(corners[0].point, corners[1].point);
  if (simplex.count == 3) weights = nearestOnTriangle(corners[0].point, corners[1].point, corners[2].point);
  simplex.weights = {weights[0], weights[1], weights[2], 0};
  return true;
}

bool holds(const Simplex& simplex, const Difference& difference) {
  for (std::size_t i = 0; i < simplex.count; ++i)
    if (simplex.corners[i].point == difference.point) return true;
  return false;
}

}  // namespace

GjkResult distanceOf(const Core& a, const Core& b, double enough) {
  const auto supportPoint = [&](const Vec3& direction) {
    const Vec3 onA = a.supportPoint(direction), onB = b.supportPoint(-direction);
    return Difference{onA - onB, onA, onB};
  };
  const double tolerance = a.isRound() || b.isRound() ? ConvexTolerances::kRoundDistance : 0;
  GjkResult best;
  best.distance = std::numeric_limits<double>::infinity();
  Simplex simplex;
  simplex.corners[0] = supportPoint(b.placed(b.collider().points[0]) - a.placed(a.collider().points[0]));
  simplex.count = 1;
  for (int round = 0; round < kMaxSimplexRounds; ++round) {
    if (!findNearest(simplex)) return {};
    simplex.reduce();
    const Vec3 nearest = simplex.nearest(&Difference::point);
    const double distance = nearest.norm();
    double size = 0;
    for (std::size_t i = 0; i < simplex.count; ++i) size = std::max(size, simplex.corners[i].onA.cwiseAbs().maxCoeff());
    if (distance <= kCoordinateRounding * size) return {};
    if (distance >= best.distance) break;  // only rounding can keep it from falling
    best = {distance, -nearest / distance, 0, simplex.nearest(&Difference::onA), simplex.nearest(&Difference::onB)};
    const Difference next = supportPoint(-nearest);
    best.lowerBound = next.point.dot(nearest) / distance;
    if (best.lowerBound > enough) break;
    if (distance - best.lowerBound <= kCoordinateRounding * size + tolerance * distance || holds(simplex, next)) break;
    simplex.corners[simplex.count++] = next;
  }
  return best;
}

}  // namespace cradle
