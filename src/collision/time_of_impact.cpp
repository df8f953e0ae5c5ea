// Conservative bisection: an interval of the step is passed over when the gap at both its ends is larger than what the
// fastest approach could close; else it is halved, the earlier half first.

#include "collision/time_of_impact.h"

#include <cmath>

namespace cradle {
namespace {

constexpr double kFinestCrossing = 1e-12;       // of a step: to this the instant of a crossing is found
constexpr double kFinestApproach = 1.0 / 4096;  // of a step: a touch that comes and goes within less is passed over

/// Pose of a body at a fraction of the step, on its cubic Hermite interpolant.
RigidTransform poseAt(const Step& step, int body, double s) {
  if (body == kFixed) return {};
  const double r = 1 - s;
  Eigen::Matrix<double, kPoseSize, 1> pose;
  const Eigen::Index at = body * kPoseSize;
  pose =
      (r * r * (1 + 2 * s)) * step.startState.segment<kPoseSize>(at) +
      (s * s * (1 + 2 * r)) * step.state.segment<kPoseSize>(at) +
      (step.timeStep * s * r) * (r * step.startRate.segment<kPoseSize>(at) - s * step.endRate.segment<kPoseSize>(at));
  return {Quat(pose[3], pose[4], pose[5], pose[6]).normalized(), pose.head<3>()};
}

/// Bound on the slope of a cubic Hermite curve over the unit interval: its three basis slopes are at most 1, 1 and 3/2.
double slopeBound(const Step& step, Eigen::Index at, Eigen::Index size) {
  return step.timeStep * (step.startRate.segment(at, size).norm() + step.endRate.segment(at, size).norm()) +
         1.5 * (step.state.segment(at, size) - step.startState.segment(at, size)).norm();
}

/// How far any point within `reach` of a body's centre of mass can move over the step, in m. An orientation quaternion
/// that moves by a turns the body by 2 a; its interpolant's length stays above one half for any step worth taking.
double motionBound(const Step& step, const BallsCollider& collider) {
  if (collider.body == kFixed) return 0;
  const Eigen::Index at = collider.body * kPoseSize;
  const double turn = 2 * slopeBound(step, at + 3, 4) / 0.5;
  return slopeBound(step, at, 3) + turn * collider.boundingRadius;
}

/// Searches one pair; keeps the earliest impact found so far in `best`.
class PairSearch {
 public:
  PairSearch(const ContactGeometry& geometry, const Step& step, std::size_t pair)
      : geometry_(geometry),
        step_(step),
        pairIndex_(pair),
        pair_(geometry.pairs[pair]),
        a_(geometry.balls[pair_.a]),
        bodyB_(pair_.againstPlane ? kFixed : geometry.balls[pair_.b].body),
        speed_(motionBound(step, a_) + (pair_.againstPlane ? 0 : motionBound(step, geometry.balls[pair_.b]))) {}

  void search(double tolerance, std::optional<ImpactTime>& best) {
    const RigidTransform startA = poseAt(step_, a_.body, 0), startB = poseAt(step_, bodyB_, 0);
    if (centreGap(startA, startB) > speed_) return;
    for (feature_ = 0; feature_ < a_.points.size(); ++feature_) {
      const double start = separation(geometry_, pair_, feature_, startA, startB);
      if (start <= tolerance || start > speed_) continue;
      const double end = best ? best->fraction : 1;
      if (const auto fraction = firstRoot(0, start, end, gap(end))) best = ImpactTime{*fraction, pairIndex_, feature_};
    }
  }

 private:
  double gap(double fraction) const {
    return separation(geometry_, pair_, feature_, poseAt(step_, a_.body, fraction), poseAt(step_, bodyB_, fraction));
  }

  /// Lower bound of the gaps of all features.
  double centreGap(const RigidTransform& worldFromA, const RigidTransform& worldFromB) const {
    if (a_.body == kFixed) return 0;
    const Vec3 centre = worldFromA.translation;
    if (pair_.againstPlane) {
      const PlaneCollider& plane = geometry_.planes[pair_.b];
      return plane.normal.dot(centre - plane.point) - a_.boundingRadius;
    }
    const BallsCollider& b = geometry_.balls[pair_.b];
    return (centre - worldFromB * b.points[0]).norm() - a_.boundingRadius - b.radius;
  }

  /// First zero of the gap in [from, to], given the gap at both ends, the first of them > 0.
  std::optional<double> firstRoot(double from, double gapFrom, double to, double gapTo) const {
    const bool crosses = gapTo <= 0;
    if (!crosses && (gapFrom + gapTo > speed_ * (to - from) || to - from < kFinestApproach)) return std::nullopt;
    if (crosses && to - from < kFinestCrossing) return to;
    const double middle = from + (to - from) / 2, gapMiddle = gap(middle);
    if (const auto root = firstRoot(from, gapFrom, middle, gapMiddle)) return root;
    if (gapMiddle <= 0) return middle;
    return firstRoot(middle, gapMiddle, to, gapTo);
  }

  const ContactGeometry& geometry_;
  const Step& step_;
  std::size_t pairIndex_, feature_ = 0;
  const ColliderPair& pair_;
  const BallsCollider& a_;
  int bodyB_;
  double speed_;  // m: bound on the relative motion over the whole step
};

}  // namespace

std::optional<ImpactTime> firstImpact(const ContactGeometry& geometry, const Step& step, double tolerance) {
  std::optional<ImpactTime> best;
  for (std::size_t pair = 0; pair < geometry.pairs.size(); ++pair)
    PairSearch(geometry, step, pair).search(tolerance, best);
  return best;
}

}  // namespace cradle
