#include "collision/core_separation.h"

#include <cmath>
#include <numeric>

#include "collision/epa.h"
#include "collision/gjk.h"
#include "collision/hill_climbing.h"

namespace cradle {
namespace {

constexpr double kTouching = 1e-12;         // of the size: nearer, the direction to the nearest point is rounding
constexpr double kSeen = 1e-14;             // of the size: rounding of a gap
constexpr double kDistanceError = 1e-5;     // of a distance: what is this near to it is its direction's local maximum
constexpr double kDistanceRounding = 1e-8;  // of a distance: what it is uncertain by if its direction is by 1e-5 rad
constexpr double kNear = 0.01;            // of the size: nearer, the normals of features are better than that direction
constexpr double kFacePreference = 1e-7;  // of the size
constexpr double kFlatError = 1e-13;      // of the size: a face that misses no more of the distance is the nearest
constexpr double kMinCosine = 0.5;        // between a face's normal and one that sees as much
constexpr double kSameCosine = 0.999;     // where that is known: the direction to nearest points is uncertain by less
constexpr double kMeeting = 1e-9;         // of the size: corners as near meet,
constexpr double kMet = 1e-13;            // and normals that see gaps as equal are alike,
constexpr double kOtherWay = 4;           // or a gap so many times as wide: corners that overlap see it from aside
constexpr double kNearlyParallel = 1e-7;  // rad: faces so little tilted touch as faces
constexpr double kSameNormal = 1e-8;      // between unit normals: those of one face
constexpr double kMovedRatio = 0.01;      // of the way between the middles

double sizeOf(const Core& a, const Core& b) {
  return std::min(a.collider().boundingRadius, b.collider().boundingRadius);
}

bool isSegment(const Core& core) {
  return core.collider().kind() == ColliderKind::capsule;
}

SeparatingAxis better(const SeparatingAxis& first, const SeparatingAxis& second) {
  return second.separation > first.separation ? second : first;
}

/// Of faces that see the same gap, as those of mirror images that tilt a little, the mean.
SeparatingAxis betterFace(const SeparatingAxis& first, const SeparatingAxis& second, const Core& a, const Core& b) {
  const bool isSame = std::abs(first.separation - second.separation) <= kMet * sizeOf(a, b) &&
                      (first.normal - second.normal).norm() < kNearlyParallel;
  if (!isSame) return better(first, second);
  const Vec3 mean = (first.normal + second.normal).normalized();
  return {gapAlong(a, b, mean), mean};
}

/// Crossing segments have no inside: any direction across both.
SeparatingAxis ofCrossingSegments(const Core& a, const Core& b) {
  const Vec3 normal = across(a.axis(), b.axis());
  if (normal.norm() > 0) return {0, normal};
  return {0, a.axis().unitOrthogonal()};
}

/// Of cores without rims that are apart. Where faces are nearly parallel the distance of their simplices stands still
/// before its direction is right, but that direction leads to the right one.
SeparatingAxis ofNearest(const GjkResult& apart, const Core& a, const Core& b) {
  if (apart.distance - apart.lowerBound <= kSeen * sizeOf(a, b)) return {apart.distance, apart.normal};
  if (apart.distance < kNear * sizeOf(a, b) && !(isSegment(a) && isSegment(b))) {
    const SeparatingAxes axes = separatingAxes(a, b);
    const SeparatingAxis feature = better(better(axes.faceOfA, axes.faceOfB), axes.edges);
    if (feature.separation >= apart.distance - kSeen * sizeOf(a, b)) return feature;
    return better(feature, climbedSupportGap({0, apart.normal}, a, b));
  }
  return climbedSupportGap({0, apart.normal}, a, b);
}

/// Of the normals of faces within an angle of `near`.
SeparatingAxis bestFlat(const Core& a, const Core& b, const Vec3& near, double leastCosine) {
  SeparatingAxis best;
  const auto look = [&](const Core& core, double sign) {
    if (core.isRound()) {
      const Vec3 normal = (core.axis().dot(near) < 0 ? -1 : 1) * core.axis();
      if (normal.dot(near) > leastCosine) best = betterFace(best, {gapAlong(a, b, normal), normal}, a, b);
    } else if (core.collider().kind() == ColliderKind::polytope) {
      for (const Polytope::Face& face : core.collider().polytope->faces) {
        const Vec3 normal = sign * core.turned(face.normal);
        if (normal.dot(near) > leastCosine) best = betterFace(best, {gapAlong(a, b, normal), normal}, a, b);
      }
    }
  };
  look(a, 1), look(b, -1);
  return best;
}

/// Apart the one maximum is near the direction to the nearest point; else there may be several.
SeparatingAxis ofRoundCores(const GjkResult& apart, const Core& a, const Core& b) {
  SeparatingAxis best;
  if (apart.distance > 0) {
    const double enough = (1 - kDistanceRounding) * apart.distance;
    best = bestFlat(a, b, apart.normal, kSameCosine);
    if (best.separation >= apart.distance - kFlatError * sizeOf(a, b)) return best;
    best = better(best, climbedSupportGap({0, apart.normal}, a, b, enough));
  }
  if (apart.distance > kTouching * sizeOf(a, b) && best.separation >= (1 - kDistanceError) * apart.distance)
    return best;
  return better(best, deepestAxis(a, b));
}

SeparatingAxis axisOfFeatures(const Core& a, const Core& b) {
  const GjkResult apart = distanceOf(a, b);
  const double preference = kFacePreference * sizeOf(a, b);
  if (a.isRound() || b.isRound()) {
    const SeparatingAxis best = ofRoundCores(apart, a, b), flat = bestFlat(a, b, best.normal, kMinCosine);
    return flat.separation >= best.separation - preference ? flat : best;
  }
  const bool isApart = apart.distance > kTouching * sizeOf(a, b);
  if (isSegment(a) && isSegment(b)) return isApart ? ofNearest(apart, a, b) : ofCrossingSegments(a, b);
  const SeparatingAxes axes = separatingAxes(a, b);
  const SeparatingAxis face = betterFace(axes.faceOfA, axes.faceOfB, a, b);
  const SeparatingAxis feature = axes.edges.separation > face.separation + preference ? axes.edges : face;
  if (!isApart || feature.separation >= apart.distance - preference) return feature;
  const SeparatingAxis nearest = ofNearest(apart, a, b);
  return nearest.separation > feature.separation + preference ? nearest : feature;
}

Vec3 middleOf(const Core& core) {
  const std::vector<Vec3>& points = core.collider().points;
  return core.placed(std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero())) / double(points.size()));
}

/// Corners that meet, or a corner and an edge, have a fan of normals. The one taken is the normal between the nearest
/// points of the cores moved apart along the line of their middles: it turns and mirrors with them. Elsewhere that
/// normal sees a smaller gap than the features' own, which stays.
SeparatingAxis amongEqual(const SeparatingAxis& axis, const Core& a, const Core& b) {
  if (std::abs(axis.separation) > kMeeting * sizeOf(a, b)) return axis;
  const Vec3 normal = separationOf(a, b.moved(kMovedRatio * (middleOf(b) - middleOf(a)))).normal;
  if ((normal - axis.normal).squaredNorm() < kSameNormal * kSameNormal) return axis;
  const SeparatingAxis between{gapAlong(a, b, normal), normal};
  const double less = axis.separation - between.separation;
  return less <= kOtherWay * std::abs(axis.separation) + kMet * sizeOf(a, b) ? between : axis;
}

}  // namespace

SeparatingAxis separationOf(const Core& a, const Core& b) {
  const GjkResult apart = distanceOf(a, b);
  if (a.isRound() || b.isRound()) return ofRoundCores(apart, a, b);
  if (apart.distance > kTouching * sizeOf(a, b)) return ofNearest(apart, a, b);
  if (isSegment(a) && isSegment(b)) return ofCrossingSegments(a, b);
  const SeparatingAxes axes = separatingAxes(a, b);
  return better(better(axes.faceOfA, axes.faceOfB), axes.edges);
}

SeparatingAxis contactAxis(const Core& a, const Core& b) {
  return amongEqual(axisOfFeatures(a, b), a, b);
}

}  // namespace cradle
