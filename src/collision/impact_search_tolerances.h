#pragma once

namespace cradle {

/// Lengths by which the search for impacts tells points and touches of a pair apart. All come from the size of a body,
/// its bounding radius; of a pair, of the smaller one unless said otherwise.
struct ImpactSearchTolerances {
  explicit ImpactSearchTolerances(double size)
      : samePlace(1e-3 * size),
        pinned(1e-8 * size),
        pinnedBand(5e-10 * size),
        leastRise(5e-17 * size),
        rounding(1e-15 * size),
        graze(1e-4 * size),
        flushArea(1e-3 * size * size) {}

  // m: a point as near to one that an active contact holds is that point. A tenth or ten times as
  // much changes no test of a search.
  double samePlace;
  // m: a point as near to a joint's anchor stays where it is. However the body turns, it moves by no more than twice as
  // much, which is as small as the coarsest tolerance for touching (1e-8 of the smallest size).
  double pinned;
  // m: how far round surfaces sink in where a joint holds them before that is an impact. Surfaces of that radius then
  // touch at an arm of sqrt(2 x 5e-10) = 3e-5 of the size from the joint, long enough for an impulse to turn the body.
  double pinnedBand;
  // m: a feature that leaves too slowly to rise so high does not leave. A hundredth of the lowest rebound that is
  // followed (EventTolerances::kOpeningRatio).
  double leastRise;
  // m: of a gap. The coordinates of bodies far from the origin are rounded more coarsely.
  double rounding;
  // m: edges of meshes may graze each other so deep unseen. A tenth or ten times as much changes no test of a search.
  double graze;
  // m^2: held corners whose arms span a larger area keep a body from tilting. A tenth or ten times as much changes no
  // test of a search.
  double flushArea;
};

}  // namespace cradle
