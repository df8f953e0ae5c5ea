// A gap seen by a normal n, -h_A(n) - h_B(-n) with the support functions h, is largest where n fits features of both
// cores: a flat face has one normal; an edge, or a cylinder's side, needs n across it; a corner allows any; and a rim's
// point moves with n. The features at a given n are few, so all their pairs are solved, and the best gap that the cores
// really have along one of the results is the next n, until there is no gain. Pairs with a rim are found as nearest
// points of a circle and a line or of two circles by Newton's method; their normal is across both tangents, which holds
// where they touch and where they overlap.

#include "collision/hill_climbing.h"

#include <array>
#include <cmath>
#include <memory_resource>

#include "collision/gjk.h"

namespace cradle {
namespace {

constexpr int kMaxRounds = 12;
constexpr int kMaxNewtonSteps = 20;
constexpr double kLongestStep = 0.5;      // rad
constexpr double kLastStep = 1e-15;       // rad
constexpr double kParallelSine = 1e-14;   // between unit vectors: rounding
constexpr double kAmbiguousCosine = 0.2;  // between normal and a cylinder's axis: either end may be the one
constexpr double kGain = 1e-15;           // of the size
constexpr double kPulledRatio = 0.01;     // of the size: far enough for a direction, near enough to come on
constexpr double kSameDirection = 1e-5;   // rad: what the direction to nearest points of round cores is uncertain by

struct Line {
  Vec3 point, direction;
};
struct Rim {
  Vec3 center, axis;
  double radius;
  Vec3 radial;  // unit: where the search starts
};

using Memory = std::pmr::monotonic_buffer_resource;

/// What a core has near the direction in which it is looked at from outside.
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

/// Turns a rim's point to where it is nearest to a line: F = d.t = 0, d from the rim's point across to the line, t the
/// tangent; F' = -r (1 - (e.t)^2) - d.u.
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

/// Turns both rims' points to where they are nearest to each other: Newton's method on |d|^2 / 2.
void turnTowards(Rim& other, Rim& rim) {
  for (int i = 0; i < kMaxNewtonSteps; ++i) {
    const Vec3 tangentA = rim.axis.cross(rim.radial), tangentB = other.axis.cross(other.radial);
    const Vec3 between = pointOf(other) - pointOf(rim);
    const double slopeA = -between.dot(tangentA), slopeB = between.dot(tangentB);  // by length along each rim
    const double bendA = 1 + between.dot(rim.radial) / rim.radius, mixed = -tangentA.dot(tangentB);
    const double bendB = 1 - between.dot(other.radial) / other.radius;
    const double determinant = bendA * bendB - mixed * mixed;
    if (!(determinant > 0 && bendA > 0)) return;
    const double stepA = (mixed * slopeB - bendB * slopeA) / determinant / rim.radius;
    const double stepB = (mixed * slopeA - bendA * slopeB) / determinant / other.radius;
    turnBy(stepA, rim), turnBy(stepB, other);
    if (std::abs(stepA) + std::abs(stepB) < kLastStep) return;
  }
}

class Ascent {
 public:
  Ascent(const SeparatingAxis& start, const Core& a, const Core& b) : a_(a), b_(b), best_(start) {
    best_.separation = gapAlong(a, b, start.normal);
  }

  SeparatingAxis climb(double enough) {
    const double size = std::min(a_.collider().boundingRadius, b_.collider().boundingRadius);
    for (int round = 0; round < kMaxRounds; ++round) {
      const double before = best_.separation;
      near_ = best_.normal;
      lookAround();
      if (best_.separation > before + kGain * size) continue;
      if (best_.separation >= enough) break;
      pullApart(size);
      if (!(best_.separation > before + kGain * size)) break;
    }
    return best_;
  }

 private:
  /// Where no feature near the normal n leads on: of the cores moved apart along n by s, the nearest points' direction
  /// m sees no less than n does, f(m) + s n.m >= f(n) + s, so that f(m) >= f(n) + s (1 - n.m).
  void pullApart(double size) {
    const Vec3 way = (kPulledRatio * size - best_.separation) * best_.normal;
    const GjkResult apart = distanceOf(a_, b_.moved(way));
    if ((apart.normal - best_.normal).squaredNorm() < kSameDirection * kSameDirection) return;
    near_ = apart.normal;
    look(near_);
    lookAround();
  }

  void lookAround() {
    std::array<std::byte, 8192> memory;
    Memory pool(memory.data(), memory.size());
    const Features ofA = featuresOf(a_, near_, &pool), ofB = featuresOf(b_, -near_, &pool);
    for (const Vec3& flat : ofA.flats) look(flat);
    for (const Vec3& flat : ofB.flats) look(-flat);
    for (const Line& lineA : ofA.lines)
      for (const Line& lineB : ofB.lines) {
        lookBothWays(across(lineA.direction, lineB.direction));
        if (ofA.corners.empty() && ofB.corners.empty())  // two cylinders that may be parallel
          lookBothWays(unitAcross(lineA.direction, lineB.point - lineA.point));
      }
    lookFromLinesToCorners(ofA, ofB, 1);
    lookFromLinesToCorners(ofB, ofA, -1);
    for (const Vec3& cornerA : ofA.corners)
      for (const Vec3& cornerB : ofB.corners) look(cornerB - cornerA);
    lookFromRims(ofA, ofB, 1);
    lookFromRims(ofB, ofA, -1);
    for (const Rim& rimA : ofA.rims)
      for (const Rim& rimB : ofB.rims) {
        Rim a = rimA, b = rimB;
        turnTowards(b, a);
        lookBothWays(across(a.axis.cross(a.radial), b.axis.cross(b.radial)));
        lookBothWays(pointOf(b) - pointOf(a));
      }
  }

  /// `sign` is -1 if the lines are B's.
  void lookFromLinesToCorners(const Features& lines, const Features& corners, double sign) {
    for (const Line& line : lines.lines)
      for (const Vec3& corner : corners.corners) look(sign * unitAcross(line.direction, corner - line.point));
  }

  void lookFromRims(const Features& rims, const Features& others, double sign) {
    for (const Rim& start : rims.rims) {
      for (const Line& line : others.lines) {
        Rim rim = start;
        turnTowards(line, rim);
        lookBothWays(across(rim.axis.cross(rim.radial), line.direction));
        lookBothWays(unitAcross(line.direction, line.point - pointOf(rim)));
      }
      for (const Vec3& corner : others.corners) {
        Rim rim = start;
        rim.radial = unitAcross(rim.axis, corner - rim.center);
        look(sign * (corner - pointOf(rim)));
      }
    }
  }

  /// Along a line of which the sense does not matter.
  void lookBothWays(const Vec3& direction) { look(direction.dot(near_) < 0 ? Vec3(-direction) : direction); }

  void look(const Vec3& direction) {
    const double length = direction.norm();
    if (!(length > 0)) return;
    const Vec3 normal = direction / length;
    const double gap = gapAlong(a_, b_, normal);
    if (gap > best_.separation) best_ = {gap, normal};
  }

  const Core &a_, &b_;
  SeparatingAxis best_;
  Vec3 near_;
};

}  // namespace

Vec3 across(const Vec3& directionA, const Vec3& directionB) {
  const Vec3 aside = without(directionA, directionB);
  const double sine = aside.norm();
  if (sine <= kParallelSine) return Vec3::Zero();
  return directionA.cross(unitAcross(directionA, directionB));
}

SeparatingAxis climbedSupportGap(const SeparatingAxis& axis, const Core& a, const Core& b, double enough) {
  return Ascent(axis, a, b).climb(enough);
}

}  // namespace cradle
