// Where something holds points of a pair together, its other points may still come together: those that are not near a
// held one.

#include <algorithm>

#include "collision/time_of_impact.h"

namespace cradle {

/// Contacts of a pair that are not held, to contacts_.
void ImpactSearch::findOthers(std::size_t pair, const std::vector<HeldFeature>& held, const VectorX& state,
                              double margin) {
  contacts_.clear();
  appendContacts(geometry_, pair, state, margin, contacts_);
  const ColliderPair& colliders = geometry_.pairs[pair];
  const double near = kHeldPlace * std::min(geometry_.colliders[colliders.a].boundingRadius,
                                            geometry_.colliders[colliders.b].boundingRadius);
  std::erase_if(contacts_, [&](const Contact& contact) {
    return std::any_of(held.begin(), held.end(), [&](const HeldFeature& feature) {
      if (feature.pair != pair) return false;
      return (poseOf(state, feature.point.body) * feature.point.point - contact.point).norm() < near;
    });
  });
}

/// The least separation of points that are not held, at most `margin`.
double ImpactSearch::gapOfOthers(std::size_t pair, const std::vector<HeldFeature>& held, const VectorX& state,
                                 double margin) {
  findOthers(pair, held, state, margin);
  double least = margin;
  for (const Contact& contact : contacts_) least = std::min(least, contact.separation);
  return least;
}

}  // namespace cradle
