// For a direction n, h(t) = min over points y of B, x of A of n.(y - x) is at most the distance, and if each n.(y -
// x)'' has a bound, h minus that bound's parabola is concave: h stays above the parabola under its chord. With n fixed
// in the world n.(y - x)'' <= n.(shift)'' + what turning adds. With n fixed in A, A's reach along it is constant, and
// n.(y - c)'' = n''.(y - c) + 2 n'.(y - c)' + n.(y - c)'' for A's centre c. A face's normal serves in its own body's
// frame: in another one the face's far end would come nearer with the turning itself, not its square.

#include "collision/separating_axis_cache.h"

#include "collision/core_separation.h"
#include "collision/gjk.h"

namespace cradle {

bool SeparatingAxisCache::during(const Bracket& ends, double threshold, const GapBounds& bounds) {
  const Interval interval{posesAt(ends.before), posesAt(ends.after), ends.after - ends.before, threshold, bounds};
  if (direction_ != Vec3::Zero() && isApart(interval)) return true;
  const Poses& nearer = ends.gapBefore < ends.gapAfter ? interval.before : interval.after;
  const Vec3 normal = separationOf(Core(a_, nearer.a), Core(b_, nearer.b)).normal;
  ++queries_;
  for (const Frame frame : {Frame::world, Frame::ofA, Frame::ofB}) {
    frame_ = frame;
    direction_ = inFrame(nearer, normal);
    if (isApart(interval)) return true;
  }
  return false;
}

bool SeparatingAxisCache::isApart(const Interval& interval) const {
  GapBounds along = interval.bounds;
  along.acceleration = frame_ == Frame::ofA ? accelerations_.ofA
                       : frame_ == Frame::ofB
                           ? accelerations_.ofB
                           : accelerations_.turning + accelerationBoundAlong(step_, a_.body, b_.body, direction_);
  const auto gapIn = [&](const Poses& poses) {
    return gapAlong(Core(a_, poses.a), Core(b_, poses.b), inWorld(poses)) - interval.threshold;
  };
  const double before = gapIn(interval.before), after = gapIn(interval.after);
  return before + along.graze > 0 && after + along.graze > 0 && staysOpen(along, before, after, interval.length);
}

Vec3 SeparatingAxisCache::inFrame(const Poses& poses, const Vec3& direction) const {
  if (frame_ == Frame::world) return direction;
  return (frame_ == Frame::ofA ? poses.a : poses.b).rotation.conjugate() * direction;
}

Vec3 SeparatingAxisCache::inWorld(const Poses& poses) const {
  if (frame_ == Frame::world) return direction_;
  return (frame_ == Frame::ofA ? poses.a : poses.b).rotation * direction_;
}

}  // namespace cradle
