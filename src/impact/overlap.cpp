#include "impact/overlap.h"

#include <algorithm>

namespace cradle {
namespace {

constexpr int kMostOverlapSweeps = 20;
constexpr double kOverlapLeft = 1e-15;  // m

}  // namespace

void resolveOverlaps(const ContactGeometry& geometry, const std::vector<Contact>& contacts,
                     const ImpulseResponse& response, VectorX& state) {
  std::vector<std::size_t> pairs;
  for (const Contact& contact : contacts)
    if (pairs.empty() || pairs.back() != contact.pair) pairs.push_back(contact.pair);
  std::vector<Contact> overlaps;
  for (int sweep = 0; sweep < kMostOverlapSweeps; ++sweep) {
    double deepest = 0;
    for (const std::size_t pair : pairs) {
      overlaps.clear();
      appendContacts(geometry, pair, state, 0, overlaps);
      // What earlier contacts of the same bodies did since it was found is seen in the next sweep.
      for (const Contact& overlap : overlaps) {
        deepest = std::max(deepest, -overlap.separation);
        const double inverseMass = overlap.normal.dot(response.inverseMassAt(overlap, state) * overlap.normal);
        response.displace(overlap, -overlap.separation / inverseMass * overlap.normal, state);
      }
    }
    if (deepest <= kOverlapLeft) return;
  }
}

}  // namespace cradle
