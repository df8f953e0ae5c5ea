#pragma once

#include "collision/collider.h"
#include "collision/first_crossing.h"
#include "dynamics/integrators/pose_interpolant.h"

namespace cradle {

/// Bounds on accelerations, in m with the step as the unit of time.
struct DirectionBends {
  double turning = 0;       // what the turning of both bodies adds to the relative acceleration of their points
  double ofA = 0, ofB = 0;  // of their points' places along a direction that turns with A, or with B
};

/// Two convex bodies over a step, neither of them with balls around its points. The bend of their distance has no
/// bound, as one corner may pass another closely; but along a direction that stays as it is, in the world or in one of
/// the bodies, the gap is the least of those of all pairs of points, and their bends have bounds.
class StayingApart {
 public:
  /// Keeps references to `step` and both colliders.
  StayingApart(const Step& step, const Collider& a, const Collider& b, const DirectionBends& bends)
      : step_(step), a_(a), b_(b), bends_(bends) {}

  /// Whether a direction tells that the bodies stay farther apart than `threshold` (m) between the ends of an interval;
  /// touches that cannot be deeper than bounds.graze are passed over. False: not known. Some farthest points where the
  /// direction of the last call serves, else a separation more.
  bool during(const Bracket& ends, double threshold, const GapBounds& bounds);

  /// How often it had to look for a direction.
  int looks() const { return looks_; }

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
  DirectionBends bends_;
  Frame frame_ = Frame::world;
  Vec3 direction_ = Vec3::Zero();  // unit, in its frame, from A to B; zero: none yet
  int looks_ = 0;
};

}  // namespace cradle
