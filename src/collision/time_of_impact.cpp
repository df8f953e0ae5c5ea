#include "collision/time_of_impact.h"

#include "collision/first_crossing.h"
#include "dynamics/integrators/pose_interpolant.h"

namespace cradle {
namespace {

/// Searches one pair; keeps the earliest impact found so far in `best`.
class PairSearch {
 public:
  PairSearch(const ContactGeometry& geometry, const Step& step, std::size_t pair)
      : geometry_(geometry),
        step_(step),
        pairIndex_(pair),
        pair_(geometry.pairs[pair]),
        a_(geometry.colliders[pair_.a]),
        bodyB_(bodyBOf(geometry, pair_)),
        bounds_(gapBounds()) {}

  void search(double tolerance, std::optional<ImpactTime>& best) {
    const RigidTransform startA = poseAt(step_, a_.body, 0), startB = poseAt(step_, bodyB_, 0);
    if (separationBound(geometry_, pair_, startA, startB) > bounds_.speed) return;
    std::vector<std::size_t> features;
    appendFeaturesWithin(geometry_, pair_, startA, bounds_.speed, features);
    for (const std::size_t feature : features) {
      feature_ = feature;
      const double start = separation(geometry_, pair_, feature_, startA, startB);
      if (start <= tolerance || start > bounds_.speed) continue;
      const double end = best ? best->fraction : 1;
      const auto gapAt = [this](double fraction) { return gap(fraction); };
      if (const auto fraction = firstCrossing(gapAt, bounds_, 0, start, end, gap(end)))
        best = ImpactTime{*fraction, pairIndex_, feature_};
    }
  }

 private:
  GapBounds gapBounds() const {
    const MotionBounds a = motionBounds(step_, a_.body, a_.boundingRadius);
    if (pair_.againstPlane) return {a.speed, a.acceleration};
    const Collider& other = geometry_.colliders[pair_.b];
    const MotionBounds b = motionBounds(step_, bodyB_, other.boundingRadius);
    const double speed = a.speed + b.speed;
    if (!a_.isBall() || !other.isBall()) return {speed};  // edges: a gap's slope may jump
    // The distance d of two centres: d'' <= relative acceleration + (speed across)^2 / d, d at least the radii's sum.
    return {speed, a.acceleration + b.acceleration + speed * speed / (a_.radius + other.radius)};
  }

  double gap(double fraction) const {
    return separation(geometry_, pair_, feature_, poseAt(step_, a_.body, fraction), poseAt(step_, bodyB_, fraction));
  }

  const ContactGeometry& geometry_;
  const Step& step_;
  std::size_t pairIndex_, feature_ = 0;
  const ColliderPair& pair_;
  const Collider& a_;
  int bodyB_;
  GapBounds bounds_;
};

}  // namespace

std::optional<ImpactTime> firstImpact(const ContactGeometry& geometry, const Step& step, double tolerance) {
  std::optional<ImpactTime> best;
  for (std::size_t pair = 0; pair < geometry.pairs.size(); ++pair)
    PairSearch(geometry, step, pair).search(tolerance, best);
  return best;
}

}  // namespace cradle
