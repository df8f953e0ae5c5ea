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
// Of the size: overlaps that steps of contact take out are shallower. Deeper ones are left the shortest way.
constexpr double kSlightOverlap = 1e-4;
// rad: two faces that are tilted by less are both flat, to kParallelAngle, for the normal between theirs.
constexpr double kSameFaces = 2 * ConvexTolerances::kParallelAngle;

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
                      (first.normal - second.normal).norm() < kSameFaces;
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

/// The normals of the faces of each that see the largest gap, of those whose cosine to `near` is larger.
SeparatingAxes facesAlong(const Vec3& near, double minCosine, const Core& a, const Core& b) {
  const auto bestOf = [&](const Core& core, double sign) {
    SeparatingAxis best;
    if (core.isRound()) {
      const Vec3 normal = (core.axis().dot(near) < 0 ? -1 : 1) * core.axis();
      if (normal.dot(near) > minCosine) best = {gapAlong(a, b, normal), normal};
    } else if (core.collider().kind() == ColliderKind::polytope) {
      for (const Polytope::Face& face : core.collider().polytope->faces) {
        const Vec3 normal = sign * core.turned(face.normal);
        if (normal.dot(near) > minCosine) best = better(best, {gapAlong(a, b, normal), normal});
      }
    }
    return best;
  };
  return {bestOf(a, 1), bestOf(b, -1), {}};
}

/// Of a face of each that see about the same overlap, as those of mirror images do whose edges or corners are in each
/// other, a direction between both takes the place of `face`. It turns and mirrors with the cores, and goes over to
/// that of the face that sees less where the other sees twice as much: faster, it would let asymmetries grow. The same
/// two corners are farthest along all of these directions n, so that |n| g(n) of (1) is linear between the faces'
/// normals.
SeparatingAxis betweenFaces(const SeparatingAxis& face, const Core& a, const Core& b) {
  const ConvexTolerances tolerances(a, b);
  const bool isSlight = face.separation < -tolerances.meeting && face.separation > -kSlightOverlap * tolerances.size;
  if (!isSlight) return face;
  const SeparatingAxes faces = facesAlong(face.normal, -ConvexTolerances::kMinCarryingCosine, a, b);
  const SeparatingAxis &ofA = faces.faceOfA, &ofB = faces.faceOfB;
  const double difference = ofA.separation - ofB.separation, most = -face.separation;
  const double beyond = std::max(0.0, std::abs(difference) - tolerances.equalGaps);
  if (!(beyond == 0 || beyond < most) || (ofA.normal - ofB.normal).norm() < kSameFaces) return face;
  const double lean = beyond == 0 ? 0 : std::copysign(beyond / most, difference);  // 1: A's normal
  const Vec3 sum = (1 + lean) * ofA.normal + (1 - lean) * ofB.normal;
  const double length = sum.norm(), linear = (1 + lean) * ofA.separation + (1 - lean) * ofB.separation;
  if (!(length > 2 * ConvexTolerances::kMinCarryingCosine)) return face;
  const SeparatingAxis between{gapAlong(a, b, sum / length), sum / length};
  return length * between.separation <= linear + tolerances.meeting ? between : face;
}

/// The axis of cores of which one has a rim. Where they are apart g(n) of (1) has one maximum, near the direction
/// between the nearest points; where they overlap there may be several, and EPA looks for the largest. Faces are tried
/// before a climb: without, mirror images that meet lose their symmetry.
SeparatingAxis axisOfRoundCores(const GjkResult& apart, const Core& a, const Core& b) {
  const ConvexTolerances tolerances(a, b);
  SeparatingAxis best;
  if (apart.distance > 0) {
    const double enough = (1 - ConvexTolerances::kRoundDistance) * apart.distance;
    const SeparatingAxes faces = facesAlong(apart.normal, ConvexTolerances::kMinCarryingCosine, a, b);
    best = betterFace(faces.faceOfA, faces.faceOfB, a, b);
    if (best.separation >= apart.distance - tolerances.equalGaps) return best;
    best = better(best, climbedSupportGap({0, apart.normal}, a, b, enough));
  }
  if (apart.distance > tolerances.touching && best.separation >= (1 - kClimbedRatio) * apart.distance) return best;
  return better(best, deepestAxis(a, b));
}

/// Whether a feature carries along the direction between nearest points of cores that are `distance` (m) apart. That is
/// known to rounding over the distance. Where corners or edges are next to each other, features of other directions see
/// a gap that is hardly smaller, and carry nothing.
bool carriesAlong(const Vec3& nearest, const SeparatingAxis& feature, double distance, const Core& a, const Core& b) {
  const double angle = ConvexTolerances::kParallelAngle + ConvexTolerances(a, b).gapRounding / distance;
  return (nearest - feature.normal).norm() < angle;
}

/// The same as axisOfFeatures, of cores of which one has a rim.
SeparatingAxis axisOfRoundFeatures(const GjkResult& apart, const Core& a, const Core& b, double preference) {
  const SeparatingAxis best = axisOfRoundCores(apart, a, b);
  const SeparatingAxes faces = facesAlong(best.normal, ConvexTolerances::kMinCarryingCosine, a, b);
  const SeparatingAxis face = betterFace(faces.faceOfA, faces.faceOfB, a, b);
  // A rim that is tilted crosses the border of a face where its polygon does not: there the normal of both is taken.
  const bool isParallel = (face.normal - best.normal).norm() <= ConvexTolerances::kParallelAngle;
  const double missed = isParallel ? preference : std::min(preference, ConvexTolerances(a, b).meeting);
  if (face.separation < best.separation - missed) return best;
  if (best.separation <= ConvexTolerances(a, b).touching) return betweenFaces(face, a, b);
  return carriesAlong(best.normal, face, best.separation, a, b) ? face : best;
}

/// The axis of (1), or the normal of a face that sees the same gap but for `preference` (m).
SeparatingAxis axisOfFeatures(const Core& a, const Core& b, double preference) {
  const GjkResult apart = distanceOf(a, b);
  if (a.isRound() || b.isRound()) return axisOfRoundFeatures(apart, a, b, preference);
  const bool isApart = apart.distance > ConvexTolerances(a, b).touching;
  if (isSegment(a) && isSegment(b)) return isApart ? axisOfNearest(apart, a, b) : axisOfCrossingSegments(a, b);
  const SeparatingAxes axes = separatingAxes(a, b);
  const SeparatingAxis face = betterFace(axes.faceOfA, axes.faceOfB, a, b);
  const SeparatingAxis feature = axes.edges.separation > face.separation + preference ? axes.edges : face;
  if (!isApart) return feature.separation > face.separation ? feature : betweenFaces(face, a, b);
  const auto carries = [&](const Vec3& nearest) { return carriesAlong(nearest, feature, apart.distance, a, b); };
  if (feature.separation >= apart.distance - preference && carries(apart.normal)) return feature;
  const SeparatingAxis nearest = axisOfNearest(apart, a, b);
  return nearest.separation > feature.separation + preference || !carries(nearest.normal) ? nearest : feature;
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
  return amongEqual(axisOfFeatures(a, b, ConvexTolerances(a, b).facePreference), a, b);
}

SeparatingAxis axisBesideFaces(const Core& a, const Core& b) {
  return amongEqual(axisOfFeatures(a, b, 0), a, b);
}

}  // namespace cradle
