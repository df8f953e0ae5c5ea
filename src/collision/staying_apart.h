#pragma once

#include "collision/collider.h"
#include "collision/first_crossing.h"
#include "dynamics/integrators/pose_interpolant.h"

namespace cradle {

/// Two convex bodies over a step, neither of them with balls around its points. The bend of their distance has no bound,
/// as one corner may pass another closely; but along a direction that stays as it is the gap is the least of those of
/// all pairs of points, and none of these bends upwards more than the bodies accelerate.
class StayingApart {
 public:
  /// Keeps references to all. `turning` bounds what the bodies' turning adds to the relative acceleration of their
  /// points, in m with the step as the unit of time.
  StayingApart(const Step& step, const Collider& a, const Collider& b, double turning)
      : step_(step), a_(a), b_(b), turning_(turning) {}

  /// Whether a direction tells that the bodies stay farther apart than `threshold` (m) between the ends of an interval;
  /// only touches that cannot be deeper than bounds.graze are passed over. False: not known. Two searches for farthest
  /// points where the direction of the last call serves, else a separation more.
  bool during(const Bracket& ends, double threshold, const GapBounds& bounds);

 private:
  struct Poses {
    RigidTransform a, b;
  };
  Poses posesAt(double fraction) const { return {poseAt(step_, a_.body, fraction), poseAt(step_, b_.body, fraction)}; }
  double gapAlongDirection(const Poses& poses) const;

  const Step& step_;
  const Collider &a_, &b_;
  double turning_;
  Vec3 direction_ = Vec3::Zero();  // unit, world, from A to B; zero: none yet
};

}  // namespace cradle
