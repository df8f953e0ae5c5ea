#include "simulate/plan/disjoint_sets.h"

#include <algorithm>
#include <numeric>

#include "dynamics/rigid_body.h"

namespace cradle {

DisjointSets::DisjointSets(std::size_t bodies) : parents_(bodies) {
  std::iota(parents_.begin(), parents_.end(), 0);
}

void DisjointSets::join(int bodyA, int bodyB) {
  if (bodyA == kFixed || bodyB == kFixed) return;
  const int islandA = islandOf(bodyA), islandB = islandOf(bodyB);
  const int first = std::min(islandA, islandB);
  for (const int last : {islandA, islandB, bodyA, bodyB}) parents_[static_cast<std::size_t>(last)] = first;
}

int DisjointSets::islandOf(int body) const {
  while (parents_[static_cast<std::size_t>(body)] != body) body = parents_[static_cast<std::size_t>(body)];
  return body;
}

}  // namespace cradle
