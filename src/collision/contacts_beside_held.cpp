// Where something holds points of a pair together, its other points may still come together: those that are not near a
// held one.

#include <algorithm>
#include <cmath>

#include "collision/time_of_impact.h"

namespace cradle {
namespace {

/// Where a contact is held together (m, world).
Vec3 heldPlace(const ContactConstraint& contact, const VectorX& state) {
  const RigidTransform worldFromB = poseOf(state, contact.surfaceB.body);
  const Vec3 center = poseOf(state, contact.centerA.body) * contact.centerA.point;
  const Vec3 normal = std::isinf(contact.radiusB) ? Vec3(worldFromB.rotation * contact.normalB)
                                                  : (center - worldFromB * contact.surfaceB.point).normalized();
  return center - contact.radiusA * normal;
}

}  // namespace

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
      return (heldPlace(feature.contact, state) - contact.point).norm() < near;
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
