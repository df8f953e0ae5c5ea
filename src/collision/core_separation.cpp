// The signed distance of two convex cores is the largest gap that a unit normal n sees,
//   d = max_n g(n), g(n) = -h_A(n) - h_B(-n),   (1)
// with the support functions h (G. van den Bergen, "Collision Detection in Interactive 3D Environments", 2003).
// For polytopes that overlap, n is one of finitely many separating axes; where they are apart GJK finds it. Cores with
// rims have no such list: hill climbing finishes from the direction of GJK, or from those of EPA where they overlap.

#include "collision/core_separation.h"

#include <cmath>
#include <numeric>

#include "collision/convex_tolerances.h"
#include "collision/epa.h"
#include "collision/gjk.h"
#include "collision/hill_climbing.h"

namespace cradle {
namespace {

// Of the size: nearer cores are asked for the axes of their features first. These are exact, while the direction
// between nearest points has an error of rounding over the distance. Farther apart that error is 1e-12 rad, and GJK is
// cheaper.
constexpr double kFeatureDistance = 0.01;
// Of the distance that GJK has found: a climb that ends lower by more has missed the maximum, and EPA looks for it.
// With 1e-4, drums with nearly parallel faces come out nearer than they are; a tenth or a hundredth changes no test.
constexpr double kClimbedRatio = 1e-5;
// Of the way between the middles: cores moved apart by as much still have the same nearest features. A tenth or ten
// times as much changes no test.
constexpr double kMovedRatio = 0.01;
// Between unit normals: a direction at which the distance stands still is known to the square root of a unit roundoff.
constexpr double kEqualNormals = 1e-8;
// Overlapping corners may see a gap so many times as deep along the normal between them as along that of a feature.
// With a tenth, mirror images that meet have normals that are not mirrored; with ten times as much, normals of slight
// overlaps do not lead out by the least way.
constexpr double kFanRatio = 4;

bool isSegment(const Core& core) {
  return core.collider().kind() == ColliderKind::capsule;
}

SeparatingAxis better(const SeparatingAxis& first, const SeparatingAxis& second) {
  return second.separation > first.separation ? second : first;
}

/// The face that sees the larger gap. Of two that see the same, as the faces of mirror images that tilt a little do,
/// the mean: it turns and mirrors with them.
SeparatingAxis betterFace(const SeparatingAxis& first, const SeparatingAxis& second, const Core& a, const Core& b) {
  const bool isSame = std::abs(first.separation - second.separation) <= ConvexTolerances(a, b).equalGaps &&
                      (first.normal - second.normal).norm() < ConvexTolerances::kParallelAngle;
  if (!isSame) return better(first, second);
  const Vec3 mean = (first.normal + second.normal).normalized();
  return {gapAlong(a, b, mean), mean};
}

/// Segments that cross have a gap of 0, which any direction across both of them sees.
SeparatingAxis axisOfCrossingSegments(const Core& a, const Core& b) {
  const Vec3 normal = across(a.axis(), b.axis());
  if (normal.norm() > 0) return {0, normal};
  return {0, a.axis().unitOrthogonal()};
}

/// The axis of cores without rims that are apart. Between nearly parallel faces GJK stops, as its distance no longer
/// falls, before its direction is right; hill climbing from that direction leads to the right one.
SeparatingAxis axisOfNearest(const GjkResult& apart, const Core& a, const Core& b) {
  const ConvexTolerances tolerances(a, b);
  if (apart.distance - apart.lowerBound <= tolerances.gapRounding) return {apart.distance, apart.normal};
  if (apart.distance < kFeatureDistance * tolerances.size && !(isSegment(a) && isSegment(b))) {
    const SeparatingAxes axes = separatingAxes(a, b);
    const SeparatingAxis feature = better(better(axes.faceOfA, axes.faceOfB), axes.edges);
    if (feature.separation >= apart.distance - tolerances.gapRounding) return feature;
    return better(feature, climbedSupportGap({0, apart.normal}, a, b));
  }
  return climbedSupportGap({0, apart.normal}, a, b);
}

/// The face normal that sees the largest gap, of faces that could carry a contact along `near`.
SeparatingAxis bestFaceNormal(const Core& a, const Core& b, const Vec3& near) {
  constexpr double minCosine = ConvexTolerances::kMinCarryingCosine;
  SeparatingAxis best;
  const auto tryFacesOf = [&](const Core& core, double sign) {
    if (core.isRound()) {
      const Vec3 normal = (core.axis().dot(near) < 0 ? -1 : 1) * core.axis();
      if (normal.dot(near) > minCosine) best = betterFace(best, {gapAlong(a, b, normal), normal}, a, b);
    } else if (core.collider().kind() == ColliderKind::polytope) {
      for (const Polytope::Face& face : core.collider().polytope->faces) {
        const Vec3 normal = sign * core.turned(face.normal);
        if (normal.dot(near) > minCosine) best = betterFace(best, {gapAlong(a, b, normal), normal}, a, b);
      }
    }
  };
  tryFacesOf(a, 1), tryFacesOf(b, -1);
  return best;
}

/// The axis of cores of which one has a rim. Where they are apart g(n) of (1) has one maximum, near the direction
/// between the nearest points; where they overlap there may be several, and EPA looks for the largest. Faces are tried
/// before a climb: without, mirror images that meet lose their symmetry.
SeparatingAxis axisOfRoundCores(const GjkResult& apart, const Core& a, const Core& b) {
  const ConvexTolerances tolerances(a, b);
  SeparatingAxis best;
  if (apart.distance > 0) {
    const double enough = (1 - ConvexTolerances::kRoundDistance) * apart.distance;
    best = bestFaceNormal(a, b, apart.normal);
    if (best.separation >= apart.distance - tolerances.equalGaps) return best;
    best = better(best, climbedSupportGap({0, apart.normal}, a, b, enough));
  }
  if (apart.distance > tolerances.touching && best.separation >= (1 - kClimbedRatio) * apart.distance) return best;
  return better(best, deepestAxis(a, b));
}

/// The axis of (1), or the normal of a face that sees the same gap but for facePreference.
SeparatingAxis axisOfFeatures(const Core& a, const Core& b) {
  const GjkResult apart = distanceOf(a, b);
  const ConvexTolerances tolerances(a, b);
  const double preference = tolerances.facePreference;
  if (a.isRound() || b.isRound()) {
    const SeparatingAxis best = axisOfRoundCores(apart, a, b);
    const SeparatingAxis face = bestFaceNormal(a, b, best.normal);
    return face.separation >= best.separation - preference ? face : best;
  }
  const bool isApart = apart.distance > tolerances.touching;
  if (isSegment(a) && isSegment(b)) return isApart ? axisOfNearest(apart, a, b) : axisOfCrossingSegments(a, b);
  const SeparatingAxes axes = separatingAxes(a, b);
  const SeparatingAxis face = betterFace(axes.faceOfA, axes.faceOfB, a, b);
  const SeparatingAxis feature = axes.edges.separation > face.separation + preference ? axes.edges : face;
  if (!isApart || feature.separation >= apart.distance - preference) return feature;
  const SeparatingAxis nearest = axisOfNearest(apart, a, b);
  return nearest.separation > feature.separation + preference ? nearest : feature;
}

Vec3 middleOf(const Core& core) {
  const std::vector<Vec3>& points = core.collider().points;
  return core.placed(std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero())) / double(points.size()));
}

/// Two corners that meet, or a corner and an edge, have a fan of normals that see the same gap. The one that is taken
/// lies between the nearest points of the cores moved apart along the line of their middles: it turns and mirrors with
/// the cores. At other features that normal sees a smaller gap than theirs, and `axis` stays.
SeparatingAxis amongEqual(const SeparatingAxis& axis, const Core& a, const Core& b) {
  const ConvexTolerances tolerances(a, b);
  if (std::abs(axis.separation) > tolerances.meeting) return axis;
  const Vec3 normal = separationOf(a, b.moved(kMovedRatio * (middleOf(b) - middleOf(a)))).normal;
  if ((normal - axis.normal).squaredNorm() < kEqualNormals * kEqualNormals) return axis;
  const SeparatingAxis between{gapAlong(a, b, normal), normal};
  const double less = axis.separation - between.separation;
  return less <= kFanRatio * std::abs(axis.separation) + tolerances.equalGaps ? between : axis;
}

}  // namespace

SeparatingAxis separationOf(const Core& a, const Core& b) {
  const GjkResult apart = distanceOf(a, b);
  if (a.isRound() || b.isRound()) return axisOfRoundCores(apart, a, b);
  if (apart.distance > ConvexTolerances(a, b).touching) return axisOfNearest(apart, a, b);
  if (isSegment(a) && isSegment(b)) return axisOfCrossingSegments(a, b);
  const SeparatingAxes axes = separatingAxes(a, b);
  return better(better(axes.faceOfA, axes.faceOfB), axes.edges);
}

SeparatingAxis contactAxis(const Core& a, const Core& b) {
  return amongEqual(axisOfFeatures(a, b), a, b);
}

}  // namespace cradle
