// Contact of all that is near a segment: capsules, and spheres as those without length. Capsules that lie along each
// other touch in a line, and a single nearest point jumps from end to end of it with the least turn: they are held at
// both ends of what they share. Seen from a point of one segment the distance to the other is convex along it, so that
// these ends are the farthest and between them there is one nearest point, which is held too where it is clearly
// nearer.

#include <algorithm>
#include <array>
#include <cmath>

#include "collision/closest_points.h"
#include "collision/predicted_manifold.h"

namespace cradle {
namespace {

// m: where capsules overlap more deeply between their two ends by more, as bent lines do, the nearest point is held
// too. A tenth of the motion with which soft contacts keep a manifold.
constexpr double kBentOverlap = 1e-4;
constexpr double kOnePointRatio = 0.25;  // of the smaller radius: points as near to each other are one
// 26 degrees: points whose normals are farther from the manifold's are not of it
constexpr double kOneManifoldCosine = 0.9;
constexpr int kMaxMeetingSteps = 3;  // of Newton's method: the distance is convex in time, so that none goes too far
// Of the sum of the radii: axes as near cross, and their offset has no direction.
constexpr double kCrossingRatio = 1e-9;
constexpr double kParallelAxesSine2 = 1e-8;  // squared sine: axes at a smaller angle have no sure common normal

Segment segmentOf(const PosedCapsule& capsule) {
  return {capsule.center - capsule.half, 2 * capsule.half};
}

/// Two segments, the second where it is when they meet.
class CapsulePair {
 public:
  CapsulePair(const PosedCapsule& a, const PosedCapsule& b)
      : a_(segmentOf(a)), b_(segmentOf(b)), radiusA_(a.radius), reach_(a.radius + b.radius) {
    onePoint_ = kOnePointRatio * std::min(a.radius, b.radius);
    findNearest();
  }

  double gap() const { return nearest_.separation; }  // m
  const Vec3& normal() const { return normal_; }

  void move(const Vec3& way) {
    ahead_ += way, b_.from += way;
    findNearest();
  }

  /// Its points nearer than `most` (m) when they meet, as they are before that. Lines are bent where they overlap more
  /// deeply between their ends by more than `bentOverlap` (m).
  PredictedManifold contact(double most, double bentOverlap) const {
    PredictedManifold manifold;
    manifold.normal = normal_;
    manifold.clearance = gap();
    const double length = a_.along.norm();
    Near ends[2];
    std::size_t count = 0;
    for (const double part : sharedParts()) {
      const Near end = nearAt(part);
      if (count == 1 && std::abs(part - ends[0].part) * length < onePoint_) continue;
      if (end.between.dot(normal_) >= kOneManifoldCosine * end.between.norm()) ends[count++] = end;
    }
    const bool isBent =
        std::none_of(ends, ends + count, [&](const Near& end) { return end.separation < gap() + bentOverlap; });
    if (isBent) add(nearest_, manifold);
    for (std::size_t k = 0; k < count; ++k) {
      if (isBent && std::abs(ends[k].part - nearest_.part) * length < onePoint_) continue;
      if (ends[k].separation <= most || ends[k].separation < gap() + bentOverlap) add(ends[k], manifold);
    }
    return manifold;
  }

 private:
  /// A point of A's segment and what is nearest to it of B's.
  struct Near {
    double part = 0;              // of A's segment
    Vec3 between = Vec3::Zero();  // m, from A's segment to B's
    double separation = 0;        // m, of the surfaces
  };

  Near nearAt(double part) const {
    const Vec3 onA = a_.at(part), between = b_.at(b_.nearestPart(onA)) - onA;
    return {part, between, between.norm() - reach_};
  }

  void findNearest() {
    const SegmentParts parts = nearestParts(a_, b_);
    const Vec3 between = b_.at(parts.b) - a_.at(parts.a);
    const double distance = between.norm();
    nearest_ = {parts.a, between, distance - reach_};
    normal_ = distance > kCrossingRatio * reach_ ? Vec3(between / distance) : normalOfCrossing();
  }

  /// Of segments through each other: across both, towards B's middle.
  Vec3 normalOfCrossing() const {
    const Vec3 offset = b_.at(0.5) - a_.at(0.5), across = a_.along.cross(b_.along);
    if (across.squaredNorm() > kParallelAxesSine2 * a_.along.squaredNorm() * b_.along.squaredNorm())
      return (across.dot(offset) < 0 ? -1 : 1) * across.normalized();
    const Vec3& along = a_.along.squaredNorm() > b_.along.squaredNorm() ? a_.along : b_.along;
    if (along.squaredNorm() > 0) return along.unitOrthogonal();
    return Vec3::UnitY();
  }

  /// Where along A's segment B's begins and ends beside it: the nearest part twice where it does not.
  std::array<double, 2> sharedParts() const {
    const double length2 = a_.along.squaredNorm();
    if (!(length2 > 0)) return {nearest_.part, nearest_.part};
    double first = a_.along.dot(b_.from - a_.from) / length2;
    double last = a_.along.dot(b_.at(1) - a_.from) / length2;
    if (first > last) std::swap(first, last);
    first = std::max(first, 0.0), last = std::min(last, 1.0);
    if (first > last) return {nearest_.part, nearest_.part};
    return {first, last};
  }

  void add(const Near& near, PredictedManifold& manifold) const {
    const Vec3 onA = a_.at(near.part) + radiusA_ * normal_;
    const Vec3 onB = onA + near.separation * normal_ - ahead_;
    manifold.points[manifold.count++] = {onA, onB, near.separation - normal_.dot(ahead_)};
  }

  Segment a_, b_;              // m
  double radiusA_, reach_;     // m; both radii together
  double onePoint_ = 0;        // m
  Vec3 ahead_ = Vec3::Zero();  // m: B's motion until they meet
  Near nearest_;
  Vec3 normal_;  // unit, from A to B
};

}  // namespace

PredictedManifold contactOfCapsules(const PosedCapsule& a, const PosedCapsule& b, const Vec3& motion, double margin,
                                    double scale) {
  PredictedManifold none;
  const double offset = (b.center - a.center).norm() - a.half.norm() - b.half.norm() - a.radius - b.radius;
  const double way = motion.norm();
  none.clearance = offset;
  if (offset - way > margin) return none;
  CapsulePair pair(a, b);
  none.clearance = pair.gap();
  double part = 0;
  for (int step = 0; step < kMaxMeetingSteps && pair.gap() > margin; ++step) {
    const double closing = -pair.normal().dot(motion);
    if (pair.gap() - (1 - part) * closing > margin) return none;
    const double now = std::min(1 - part, pair.gap() / closing);
    pair.move(now * motion);
    part += now;
  }
  return pair.gap() > margin ? none : pair.contact(margin + way, scale * kBentOverlap);
}

PredictedManifold contactOfCapsuleAndPlane(const PosedCapsule& a, const PlaneCollider& b, const Vec3& motion,
                                           double margin) {
  const double reach = margin + std::max(0.0, b.normal.dot(motion));
  const double middle = b.normal.dot(a.center - b.point) - a.radius, rise = b.normal.dot(a.half);
  PredictedManifold manifold;
  manifold.normal = -b.normal;
  manifold.clearance = middle - std::abs(rise);
  for (const double side : {-1.0, 1.0}) {
    const double height = middle + side * rise;
    if (height > reach) continue;
    const Vec3 at = a.center + side * a.half - a.radius * b.normal;
    manifold.points[manifold.count++] = {at, at - height * b.normal, height};
  }
  return manifold;
}

}  // namespace cradle
