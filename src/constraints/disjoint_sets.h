#pragma once

#include <set>
#include <utility>
#include <vector>

#include "dynamics/rigid_body.h"

namespace cradle {

/// Disjoint sets of bodies (union-find: R. E. Tarjan, 1975), joined two by two. Fixed bodies join nothing.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t bodies);

  /// Driven bodies join nothing either: no impulse at one of them reaches another.
  explicit DisjointSets(const std::vector<RigidBody>& bodies);

  /// Either may be kFixed.
  void join(int bodyA, int bodyB);

  /// The first body of a body's set: the same for all that are joined. O(1) after flatten(), else O(bodies) at worst.
  int islandOf(int body) const;

  /// The same for the first of two bodies that is neither fixed nor driven; one must be such.
  int islandOf(int bodyA, int bodyB) const { return islandOf(joinsNothing(bodyA) ? bodyB : bodyA); }

  /// Makes islandOf fast until the next join. O(bodies).
  void flatten();

 private:
  int halvePath(int body);
  bool joinsNothing(int body) const;

  std::vector<int> parents_;    // each at most its own index
  std::vector<char> isDriven_;  // none, if empty
};

/// Whether pairs of the elements 0 ... elements - 1, each joined once, close a loop. O(pairs log elements).
bool closeALoop(const std::set<std::pair<int, int>>& pairs, std::size_t elements);

}  // namespace cradle
