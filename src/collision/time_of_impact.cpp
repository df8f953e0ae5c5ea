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
        speed_(motionBound(step, a_.body, a_.boundingRadius) +
               (pair_.againstPlane ? 0 : motionBound(step, bodyB_, geometry.colliders[pair_.b].boundingRadius))) {}

  void search(double tolerance, std::optional<ImpactTime>& best) {
    const RigidTransform startA = poseAt(step_, a_.body, 0), startB = poseAt(step_, bodyB_, 0);
    if (separationBound(geometry_, pair_, startA, startB) > speed_) return;
    std::vector<std::size_t> features;
    appendFeaturesWithin(geometry_, pair_, startA, speed_, features);
    for (const std::size_t feature : features) {
      feature_ = feature;
      const double start = separation(geometry_, pair_, feature_, startA, startB);
      if (start <= tolerance || start > speed_) continue;
      const double end = best ? best->fraction : 1;
      const auto gapAt = [this](double fraction) { return gap(fraction); };
      if (const auto fraction = firstCrossing(gapAt, speed_, 0, start, end, gap(end)))
        best = ImpactTime{*fraction, pairIndex_, feature_};
    }
  }

 private:
  double gap(double fraction) const {
    return separation(geometry_, pair_, feature_, poseAt(step_, a_.body, fraction), poseAt(step_, bodyB_, fraction));
  }

  const ContactGeometry& geometry_;
  const Step& step_;
  std::size_t pairIndex_, feature_ = 0;
  const ColliderPair& pair_;
  const Collider& a_;
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
