#pragma once

#include <vector>

namespace cradle {

/// Disjoint sets of bodies (union-find: R. E. Tarjan, 1975), joined two by two. Fixed bodies join nothing.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t bodies);

  /// Either may be kFixed.
  void join(int bodyA, int bodyB);

  /// The first body of a body's set: the same for all that are joined. O(1) after flatten(), else O(bodies) at worst.
  int islandOf(int body) const;

  /// Makes islandOf fast until the next join. O(bodies).
  void flatten();

 private:
  int halvePath(int body);

  std::vector<int> parents_;  // each at most its own index
};

}  // namespace cradle
