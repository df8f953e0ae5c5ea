#include "collision/time_of_impact.h"

#include "collision/pair_search.h"

namespace cradle {
namespace {

// Of the size: reach of the first search for a gap, and its growth while no gap is found. They decide the cost alone.
constexpr double kFirstMarginReach = 1e-4, kMarginReachGrowth = 10;

}  // namespace

const MotionBounds& ImpactSearch::turnOf(const Step& step, int body) {
  static constexpr MotionBounds kStill;
  if (body == kFixed) return kStill;
  Turn& turn = turns_[static_cast<std::size_t>(body)];
  if (!turn.isKnown) turn = {true, turnBounds(step, body)};
  return turn.bounds;
}

double ImpactSearch::margin(const ImpactTime& impact, const TouchingFeatures& touching, const VectorX& state) {
  const ColliderPair& pair = geometry_.pairs[impact.pair];
  const Collider& a = geometry_.colliders[pair.a];
  if (impact.face) {
    const Collider& b = geometry_.colliders[pair.b];
    return heightOfCorner(*impact.face, impact.feature, {a, poseOf(state, a.body)}, {b, poseOf(state, b.body)}) -
           impact.threshold;
  }
  if (!impact.isOfOthers) return separation(geometry_, pair, impact.feature, state) - impact.threshold;
  // Near an impact the gap is small: a search within a whole size could visit thousands of triangles.
  double gap = 0;
  for (double reach = kFirstMarginReach * a.boundingRadius;; reach *= kMarginReachGrowth) {
    gap = gapBesideHeld(geometry_, impact.pair, touching.activeFeatures(), state, reach, contacts_);
    if (gap < reach || reach >= a.boundingRadius) break;
  }
  return gap - impact.threshold;
}

std::optional<ImpactTime> ImpactSearch::first(const Step& step, const TouchingFeatures& touching) {
  const auto bodies = static_cast<std::size_t>(bodyCount(step.state));
  turns_.assign(bodies, {});
  sample_.resize(step.state.size());
  isMoving_.resize(bodies);
  for (std::size_t body = 0; body < bodies; ++body) isMoving_[body] = !isStill(step, static_cast<int>(body));
  const auto moves = [this](int body) { return body != kFixed && isMoving_[static_cast<std::size_t>(body)]; };
  std::optional<ImpactTime> best;
  for (std::size_t pair = 0; pair < geometry_.pairs.size(); ++pair) {
    const ColliderPair& bodiesOf = geometry_.pairs[pair];
    if (moves(geometry_.colliders[bodiesOf.a].body) || moves(bodyBOf(geometry_, bodiesOf)))
      PairSearch(*this, step, pair).search(touching, best);
  }
  return best;
}

}  // namespace cradle
