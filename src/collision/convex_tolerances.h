#pragma once

#include <algorithm>

#include "collision/core.h"

namespace cradle {

/// Tolerances of all queries on two convex cores: GJK, EPA, hill climbing, separating axes, contact manifolds. Lengths
/// follow from the size of the smaller core and from u = 1.1e-16, the unit roundoff of a double.
struct ConvexTolerances {
  // rad, or the sine: directions at a smaller angle are parallel. The gap that a normal sees changes with the square of
  // an angle where it is largest, and the square of this one is the rounding of a gap.
  static constexpr double kParallelAngle = 1e-7;
  // Between the normal of a face and that of the contact, 60 degrees: a face that is tilted more does not carry it.
  static constexpr double kMinCarryingCosine = 0.5;
  // Of the distance: GJK on a core with a rim, which adds support points without end, stops when its bounds of the
  // distance are as near to each other. The true distance is less by no more; hill climbing finds it from there.
  static constexpr double kRoundDistance = 1e-8;

  /// `smallerSize` (m): bounding radius of the smaller core.
  explicit ConvexTolerances(double smallerSize)
      : size(smallerSize),
        gapRounding(1e-14 * size),
        equalGaps(1e-13 * size),
        touching(1e-12 * size),
        meeting(1e-9 * size),
        facePreference(kParallelAngle * size),
        pulledApart(0.01 * size) {}
  ConvexTolerances(const Core& a, const Core& b)
      : ConvexTolerances(std::min(a.collider().boundingRadius, b.collider().boundingRadius)) {}

  double size;         // m
  double gapRounding;  // m: 90 u of the size. A gap is a sum of some ten products, of terms of a few sizes
  double equalGaps;    // m: ten roundings. Two normals that see gaps as equal see the same
  double touching;     // m: a hundred roundings. Nearest points at that distance tell their direction to 0.01 rad
  // m: corners as near to each other meet. With a tenth, mirror images that meet have normals that are not mirrored;
  // with ten times as much, normals of slight overlaps do not lead out by the least way.
  double meeting;
  double facePreference;  // m: a gap that a face's normal may miss and still be taken: kParallelAngle over the size
  double pulledApart;     // m: cores moved apart by as much have nearest points with a direction good to 1e-12 rad
};

}  // namespace cradle
