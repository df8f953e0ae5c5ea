#pragma once

#include "collision/collider.h"
#include "collision/root_bracketing.h"
#include "dynamics/integrators/pose_interpolant.h"

namespace cradle {

/// Bounds on accelerations, in m with the step as the unit of time.
struct DirectionAccelerations {
  double turning = 0;       // what the turning of both bodies adds to the relative acceleration of their points
  double ofA = 0, ofB = 0;  // of their points' places along a direction that turns with A, or with B
};

/// A separating axis of two convex bodies that is kept over a step, as long as it separates them; neither body has
/// spheres around its points. The second derivative of their distance has no bound, as one corner may pass another
/// closely; but along a direction that stays as it is, in the world or in one of the bodies, the gap is the least of
/// those of all pairs of points, and their accelerations have bounds.
class SeparatingAxisCache {
 public:
  /// Keeps references to `step` and both colliders.
  SeparatingAxisCache(const Step& step, const Collider& a, const Collider& b,
                      const DirectionAccelerations& accelerations)
      : step_(step), a_(a), b_(b), accelerations_(accelerations) {}

  /// Whether a direction tells that the bodies stay farther apart than `threshold` (m) between the ends of an interval;
  /// touches that cannot be deeper than bounds.graze are passed over. False: not known. Some support points where the
  /// direction of the last call serves, else a separation more.
  bool during(const Bracket& ends, double threshold, const GapBounds& bounds);

  /// How often it had to look for a direction.
  int queries() const { return queries_; }

 private:
  enum class Frame { world, ofA, ofB };
  struct Poses {
    RigidTransform a, b;
  };
  /// A question to `during`.
  struct Interval {
    Poses before, after;
    double length, threshold;
    const GapBounds& bounds;
  };
  Poses posesAt(double fraction) const { return {poseAt(step_, a_.body, fraction), poseAt(step_, b_.body, fraction)}; }
  bool isApart(const Interval& interval) const;
  Vec3 inFrame(const Poses& poses, const Vec3& direction) const;
  Vec3 inWorld(const Poses& poses) const;

  const Step& step_;
  const Collider &a_, &b_;
  DirectionAccelerations accelerations_;
  Frame frame_ = Frame::world;
  Vec3 direction_ = Vec3::Zero();  // unit, in its frame, from A to B; zero: none yet
  int queries_ = 0;
};

}  // namespace cradle
