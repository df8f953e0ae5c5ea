// The support gap g(n) = -h_A(n) - h_B(-n), with the support functions h, has its local maxima at normals n that fit
// features of both cores: a face has one normal; an edge, or a cylinder's side, needs n across it; a corner allows any
// n; and the point of a rim moves with n. Few features are near a given n. One round solves all pairs of them for their
// normals, and goes on from the normal with the largest gap of the whole cores, until there is no gain. The nearest
// points of a rim and a line, or of two rims, are found by Newton's method; their normal is across both tangents, where
// they touch as well as where they overlap.

#include "collision/hill_climbing.h"

#include <array>
#include <cmath>
#include <memory_resource>

#include "collision/convex_tolerances.h"
#include "collision/gjk.h"

namespace cradle {
namespace {

constexpr int kMaxClimbRounds = 12;  // half or twice as many change no test
constexpr int kMaxNewtonSteps = 20;  // each doubles the digits; half or twice as many change no test
// rad: Newton's steps are cut to it, so that a rim's point stays on its side of the rim. A tenth or ten times as much
// changes no test.
constexpr double kLongestStep = 0.5;
constexpr double kLastStep = 1e-15;  // rad: ten unit roundoffs of a unit vector
// Sine: the cross product of unit vectors at a smaller angle, 90 unit roundoffs, has no digit that is not rounding.
constexpr double kNoCrossProduct = 1e-14;
// Cosine between the direction and a cylinder's axis: within it, 0.2 rad of the side, the rims of both ends are tried.
// With 0.002, or with both always, no gap of 117000 random pairs with cylinders changes by more than rounding.
constexpr double kAmbiguousCosine = 0.2;
constexpr double kGainRatio = 1e-15;  // of the size: a gain by less is rounding, and ends the climb
// rad: nearest points whose direction is as near to that of the climb lead nowhere else. A tenth or ten times as much
// changes no test.
constexpr double kNoNewDirection = 1e-5;

struct Line {
  Vec3 point, direction;
};
struct Rim {
  Vec3 center, axis;
  double radius;
  Vec3 radial;  // unit: where the search starts
};

using Memory = std::pmr::monotonic_buffer_resource;

/// The features of a core that are near its support point in a direction.
struct Features {
  explicit Features(Memory* memory) : flats(memory), lines(memory), rims(memory), corners(memory) {}
  std::pmr::vector<Vec3> flats;  // outward normals
  std::pmr::vector<Line> lines;  // edges, or a cylinder's axis in place of its side
  std::pmr::vector<Rim> rims;
  std::pmr::vector<Vec3> corners;
};

void addCylinder(const Core& core, const Vec3& outward, Features& features) {
  const double cosine = core.axis().dot(outward);
  features.lines.push_back({core.center(), core.axis()});
  const Vec3 radial = unitAcross(core.axis(), outward);
  for (const double side : {1.0, -1.0}) {
    if (side * cosine < -kAmbiguousCosine) continue;
    features.flats.push_back(side * core.axis());
    features.rims.push_back({core.end(side), core.axis(), core.rimRadius(), radial});
  }
}

void addPolytope(const Core& core, const Vec3& outward, Features& features) {
  const Polytope& polytope = *core.collider().polytope;
  const std::size_t vertex = supportVertex(polytope, core.turnedBack(outward));
  const Vec3 corner = core.placed(polytope.vertices[vertex]);
  features.corners.push_back(corner);
  for (std::size_t i = polytope.firstNeighbor[vertex]; i < polytope.firstNeighbor[vertex + 1]; ++i) {
    const Polytope::Edge& edge = polytope.edges[polytope.edgesAt[i]];
    features.lines.push_back({corner, core.placed(polytope.vertices[polytope.neighbors[i]]) - corner});
    features.lines.back().direction.normalize();
    // Each face at the corner is on the left of one edge that starts there, or on the right of one that ends there.
    features.flats.push_back(core.turned(polytope.faces[edge.from == vertex ? edge.left : edge.right].normal));
  }
}

void addSegment(const Core& core, const Vec3& outward, Features& features) {
  features.corners.push_back(core.supportPoint(outward));
  features.lines.push_back({core.center(), core.axis()});
}

Features featuresOf(const Core& core, const Vec3& outward, Memory* memory) {
  Features features(memory);
  switch (core.collider().kind()) {
    case ColliderKind::sphere:
      features.corners.push_back(core.supportPoint(outward));
      break;
    case ColliderKind::capsule:
      addSegment(core, outward, features);
      break;
    case ColliderKind::cylinder:
      addCylinder(core, outward, features);
      break;
    case ColliderKind::polytope:
    case ColliderKind::mesh:
      addPolytope(core, outward, features);
      break;
  }
  return features;
}

Vec3 without(const Vec3& direction, const Vec3& vector) {
  return vector - direction.dot(vector) * direction;
}

void turnBy(double angle, Rim& rim) {
  const double limited = std::min(std::max(angle, -kLongestStep), kLongestStep);
  rim.radial = (rim.radial + limited * rim.axis.cross(rim.radial)).normalized();
}

Vec3 pointOf(const Rim& rim) {
  return rim.center + rim.radius * rim.radial;
}

/// Turns a rim's point to where it is nearest to a line, by Newton's method on F = d . t = 0: d leads from the point
/// straight to the line, t is the rim's tangent, e the line's direction, u the radial direction, r the radius, and
/// dF/dangle = -r (1 - (e . t)^2) - d . u.
void turnTowards(const Line& line, Rim& rim) {
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const Vec3 tangent = rim.axis.cross(rim.radial), between = without(line.direction, line.point - pointOf(rim));
    const double cosine = line.direction.dot(tangent);
    const double slope = -rim.radius * (1 - cosine * cosine) - between.dot(rim.radial);
    if (!(slope < 0)) return;
    const double step = -between.dot(tangent) / slope;
    turnBy(step, rim);
    if (std::abs(step) < kLastStep) return;
  }
}

/// Turns both rims' points to where they are nearest to each other: Newton's method on the minimum of |d|^2 / 2, where
/// d leads from one to the other.
void turnTowards(Rim& other, Rim& rim) {
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const Vec3 tangentA = rim.axis.cross(rim.radial), tangentB = other.axis.cross(other.radial);
    const Vec3 between = pointOf(other) - pointOf(rim);
    // First and second derivatives by the length along each rim.
    const double slopeA = -between.dot(tangentA), slopeB = between.dot(tangentB);
    const double secondA = 1 + between.dot(rim.radial) / rim.radius, mixed = -tangentA.dot(tangentB);
    const double secondB = 1 - between.dot(other.radial) / other.radius;
    const double determinant = secondA * secondB - mixed * mixed;
    if (!(determinant > 0 && secondA > 0)) return;
    const double stepA = (mixed * slopeB - secondB * slopeA) / determinant / rim.radius;
    const double stepB = (mixed * slopeA - secondA * slopeB) / determinant / other.radius;
    turnBy(stepA, rim), turnBy(stepB, other);
    if (std::abs(stepA) + std::abs(stepB) < kLastStep) return;
  }
}

class HillClimb {
 public:
  HillClimb(const SeparatingAxis& start, const Core& a, const Core& b) : a_(a), b_(b), best_(start) {
    best_.separation = gapAlong(a, b, start.normal);
  }

  SeparatingAxis climb(double enough) {
    const ConvexTolerances tolerances(a_, b_);
    const double gain = kGainRatio * tolerances.size;
    for (int round = 0; round < kMaxClimbRounds; ++round) {
      const double before = best_.separation;
      near_ = best_.normal;
      tryFeaturePairs();
      if (best_.separation > before + gain) continue;
      if (best_.separation >= enough) break;
      tryCoresApart(tolerances.pulledApart);
      if (!(best_.separation > before + gain)) break;
    }
    return best_;
  }

 private:
  /// Leads on where no feature near the normal n does. Moved apart along n by a length s, the cores have the support
  /// gap g(m) + s n . m, whose largest value is their distance, at the direction m between their nearest points. So
  /// g(m) + s n . m >= g(n) + s, and g(m) >= g(n) + s (1 - n . m): no less than before. `distance` (m) is that of the
  /// cores along n after the move.
  void tryCoresApart(double distance) {
    const Vec3 way = (distance - best_.separation) * best_.normal;
    const GjkResult apart = distanceOf(a_, b_.moved(way));
    if ((apart.normal - best_.normal).squaredNorm() < kNoNewDirection * kNoNewDirection) return;
    near_ = apart.normal;
    tryDirection(near_);
    tryFeaturePairs();
  }

  void tryFeaturePairs() {
    std::array<std::byte, 8192> memory;
    Memory pool(memory.data(), memory.size());
    const Features ofA = featuresOf(a_, near_, &pool), ofB = featuresOf(b_, -near_, &pool);
    for (const Vec3& flat : ofA.flats) tryDirection(flat);
    for (const Vec3& flat : ofB.flats) tryDirection(-flat);
    for (const Line& lineA : ofA.lines)
      for (const Line& lineB : ofB.lines) {
        tryBothSenses(across(lineA.direction, lineB.direction));
        if (ofA.corners.empty() && ofB.corners.empty())  // two cylinders that may be parallel
          tryBothSenses(unitAcross(lineA.direction, lineB.point - lineA.point));
      }
    tryLinesWithCorners(ofA, ofB, 1);
    tryLinesWithCorners(ofB, ofA, -1);
    for (const Vec3& cornerA : ofA.corners)
      for (const Vec3& cornerB : ofB.corners) tryDirection(cornerB - cornerA);
    tryRims(ofA, ofB, 1);
    tryRims(ofB, ofA, -1);
    for (const Rim& rimA : ofA.rims)
      for (const Rim& rimB : ofB.rims) {
        Rim a = rimA, b = rimB;
        turnTowards(b, a);
        tryBothSenses(across(a.axis.cross(a.radial), b.axis.cross(b.radial)));
        tryBothSenses(pointOf(b) - pointOf(a));
      }
  }

  /// `sign` is -1 if the lines are B's.
  void tryLinesWithCorners(const Features& lines, const Features& corners, double sign) {
    for (const Line& line : lines.lines)
      for (const Vec3& corner : corners.corners) tryDirection(sign * unitAcross(line.direction, corner - line.point));
  }

  /// Rims of one core with lines and corners of the other. `sign` is -1 if the rims are B's.
  void tryRims(const Features& rims, const Features& others, double sign) {
    for (const Rim& start : rims.rims) {
      for (const Line& line : others.lines) {
        Rim rim = start;
        turnTowards(line, rim);
        tryBothSenses(across(rim.axis.cross(rim.radial), line.direction));
        tryBothSenses(unitAcross(line.direction, line.point - pointOf(rim)));
      }
      for (const Vec3& corner : others.corners) {
        Rim rim = start;
        rim.radial = unitAcross(rim.axis, corner - rim.center);
        tryDirection(sign * (corner - pointOf(rim)));
      }
    }
  }

  /// Tries a direction in the sense in which it is nearer to that of the round.
  void tryBothSenses(const Vec3& direction) { tryDirection(direction.dot(near_) < 0 ? Vec3(-direction) : direction); }

  /// Keeps a direction if it sees a larger gap than the best one.
  void tryDirection(const Vec3& direction) {
    const double length = direction.norm();
    if (!(length > 0)) return;
    const Vec3 normal = direction / length;
    const double gap = gapAlong(a_, b_, normal);
    if (gap > best_.separation) best_ = {gap, normal};
  }

  const Core &a_, &b_;
  SeparatingAxis best_;
  Vec3 near_;  // unit: features near it are paired in this round
};

}  // namespace

Vec3 across(const Vec3& directionA, const Vec3& directionB) {
  const Vec3 aside = without(directionA, directionB);
  const double sine = aside.norm();
  if (sine <= kNoCrossProduct) return Vec3::Zero();
  return directionA.cross(unitAcross(directionA, directionB));
}

SeparatingAxis climbedSupportGap(const SeparatingAxis& axis, const Core& a, const Core& b, double enough) {
  return HillClimb(axis, a, b).climb(enough);
}

}  // namespace cradle
