#pragma once

#include <set>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "simulate/plan/plan.h"
#include "simulate/plan/reach.h"

namespace cradle {

/// Which bodies may touch each other, as far as their reaches tell. What touches something may be thrown anywhere that
/// its constraints allow.
class ReachablePairs {
 public:
  /// Keeps a reference to `scene`. O(pairs of bodies), some 1e-8 s for each.
  explicit ReachablePairs(const Scene& scene);

  bool mayMeet(int first, int second) const;

 private:
  const Scene& scene_;
  std::vector<Reach> reaches_;  // by body
  std::vector<double> sizes_;   // m, by body
  std::set<std::pair<int, int>> joined_;
};

/// Moving bodies that depend on each other, by constraints or springs or by contact that their reaches allow, each
/// island with what it may touch; methods are not chosen. O(pairs of bodies), some 1e-8 s for each.
std::vector<IslandPlan> findIslands(const Scene& scene, const ReachablePairs& reachable);

/// Calls visit(bodyA, bodyB) for every spring, rod, rope, ball joint and hinge; kWorld stands for the world.
template <class Visit>
void forEachLink(const Scene& scene, const Visit& visit) {
  const auto all = [&](const auto& links) {
    for (const auto& link : links) visit(link.anchorA.body, link.anchorB.body);
  };
  all(scene.springs), all(scene.rods), all(scene.ropes), all(scene.ballJoints), all(scene.hinges);
}

}  // namespace cradle
