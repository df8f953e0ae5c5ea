// For a direction n that is fixed in the world, h(t) = min over points y of B, x of A of n.(y - x) is at most the
// distance, and each n.(y - x)'' <= n.(shift)'' + what turning adds: h minus that bound's parabola is concave, so that h
// stays above the parabola under its chord. (The directions that see the gap best turn with the bodies, slower than
// intervals shrink.)

#include "collision/staying_apart.h"

#include "collision/core_distance.h"
#include "collision/core_separation.h"

namespace cradle {

bool StayingApart::during(const Bracket& ends, double threshold, const GapBounds& bounds) {
  const Poses before = posesAt(ends.before), after = posesAt(ends.after);
  const auto isApart = [&] {
    GapBounds along = bounds;
    along.acceleration = turning_ + accelerationBoundAlong(step_, a_.body, b_.body, direction_);
    const double gapBefore = gapAlongDirection(before) - threshold, gapAfter = gapAlongDirection(after) - threshold;
    return gapBefore + bounds.graze > 0 && gapAfter + bounds.graze > 0 &&
           staysOpen(along, gapBefore, gapAfter, ends.after - ends.before);
  };
  if (direction_ != Vec3::Zero() && isApart()) return true;
  const Poses& nearer = ends.gapBefore < ends.gapAfter ? before : after;
  direction_ = separationOf(Core(a_, nearer.a), Core(b_, nearer.b)).normal;
  return isApart();
}

double StayingApart::gapAlongDirection(const Poses& poses) const {
  return gapAlong(Core(a_, poses.a), Core(b_, poses.b), direction_);
}

}  // namespace cradle
