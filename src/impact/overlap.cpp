#include "impact/overlap.h"

#include <algorithm>
#include <numeric>

namespace cradle {
namespace {

constexpr int kMaxOverlapSweeps = 20;   // over all pairs; those that press each other go on for ever
constexpr double kOverlapLeft = 1e-15;  // m: rounding of places a metre from the origin
// Of the inverse mass without constraints: less is rounding, and the constraints hold the pair.
constexpr double kMinWay = 1e-9;

/// Adds the displacement, in place of velocities, that takes the overlaps of one pair out. Many with one normal are
/// one: what the deepest needs is enough for all.
void addDisplacement(const std::vector<Contact>& overlaps, const ImpulseResponse& response, const VectorX& state,
                     VectorX& displacement) {
  for (const Contact& overlap : overlaps) {
    const double left = -overlap.separation - openingSpeed(overlap, displacement);
    if (left <= 0) continue;
    const double inverseMass = overlap.normal.dot(response.delassusAt(overlap, state) * overlap.normal);
    const double untied = overlap.normal.dot(response.unconstrainedDelassusAt(overlap, state) * overlap.normal);
    if (!(inverseMass > kMinWay * untied)) continue;
    response.apply(overlap, left / inverseMass * overlap.normal, displacement);
  }
}

/// Moves bodies by their displacements, in place of velocities, which begin anew for the next pair.
void displace(const std::vector<int>& bodies, VectorX& displacement, VectorX& state) {
  for (const int body : bodies) {
    if (body == kFixed) continue;
    centerOfMass(state, body) += linearVelocity(displacement, body);
    turnBody(state, body, angularVelocity(displacement, body));
    centerOfMass(displacement, body) = centerOfMass(state, body);
    setOrientation(displacement, body, orientation(state, body));
    linearVelocity(displacement, body).setZero();
    angularVelocity(displacement, body).setZero();
  }
}

}  // namespace

void resolveOverlaps(const ContactGeometry& geometry, const std::vector<Contact>& contacts,
                     const ImpulseResponse& response, VectorX& state) {
  std::vector<std::size_t> pairs;
  for (const Contact& contact : contacts)
    if (pairs.empty() || pairs.back() != contact.pair) pairs.push_back(contact.pair);
  std::vector<Contact> overlaps;
  VectorX displacement = state;
  displacement.tail(state.size() - poseComponents(state)).setZero();
  // A pair without constraints moves its own bodies alone.
  std::vector<int> moved(static_cast<std::size_t>(bodyCount(state)));
  std::iota(moved.begin(), moved.end(), 0);
  for (int sweep = 0; sweep < kMaxOverlapSweeps; ++sweep) {
    double deepest = 0;
    for (const std::size_t pair : pairs) {
      overlaps.clear();
      appendContacts(geometry, pair, state, 0, overlaps);
      if (overlaps.empty()) continue;
      std::stable_sort(overlaps.begin(), overlaps.end(),
                       [](const Contact& a, const Contact& b) { return a.separation < b.separation; });
      deepest = std::max(deepest, -overlaps[0].separation);
      addDisplacement(overlaps, response, state, displacement);
      if (!response.areConstrained()) moved = {overlaps[0].bodyA, overlaps[0].bodyB};
      displace(moved, displacement, state);
    }
    if (deepest <= kOverlapLeft) return;
  }
}

}  // namespace cradle
