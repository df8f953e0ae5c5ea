#include "constraints/disjoint_sets.h"

#include <algorithm>
#include <numeric>

namespace cradle {

DisjointSets::DisjointSets(std::size_t bodies) : parents_(bodies) {
  std::iota(parents_.begin(), parents_.end(), 0);
}

DisjointSets::DisjointSets(const std::vector<RigidBody>& bodies) : DisjointSets(bodies.size()) {
  for (const RigidBody& body : bodies) isDriven_.push_back(body.isDriven());
}

bool DisjointSets::joinsNothing(int body) const {
  return body == kFixed || (!isDriven_.empty() && isDriven_[static_cast<std::size_t>(body)]);
}

void DisjointSets::join(int bodyA, int bodyB) {
  if (joinsNothing(bodyA) || joinsNothing(bodyB)) return;
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

bool closeALoop(const std::set<std::pair<int, int>>& pairs, std::size_t elements) {
  DisjointSets chains(elements);
  for (const auto& [a, b] : pairs) {
    if (chains.islandOf(a) == chains.islandOf(b)) return true;
    chains.join(a, b);
  }
  return false;
}

}  // namespace cradle
