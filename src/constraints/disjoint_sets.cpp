#include "constraints/disjoint_sets.h"

#include <algorithm>
#include <numeric>

#include "dynamics/rigid_body.h"

namespace cradle {

DisjointSets::DisjointSets(std::size_t bodies) : parents_(bodies) {
  std::iota(parents_.begin(), parents_.end(), 0);
}

void DisjointSets::join(int bodyA, int bodyB) {
  if (bodyA == kFixed || bodyB == kFixed) return;
  const auto [first, last] = std::minmax({halvePath(bodyA), halvePath(bodyB)});
  parents_[static_cast<std::size_t>(last)] = first;
}

/// islandOf, with half of the way for the next time (R. E. Tarjan, J. van Leeuwen, 1984).
int DisjointSets::halvePath(int body) {
  while (parents_[static_cast<std::size_t>(body)] != body) {
    int& parent = parents_[static_cast<std::size_t>(body)];
    parent = parents_[static_cast<std::size_t>(parent)];
    body = parent;
  }
  return body;
}

// Parents come before their children.
void DisjointSets::flatten() {
  for (int& parent : parents_) parent = parents_[static_cast<std::size_t>(parent)];
}

int DisjointSets::islandOf(int body) const {
  while (parents_[static_cast<std::size_t>(body)] != body) body = parents_[static_cast<std::size_t>(body)];
  return body;
}

}  // namespace cradle
