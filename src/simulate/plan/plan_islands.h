#pragma once

#include <vector>

#include "scene/scene.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// Moving bodies that depend on each other, by ties or springs or by contact that their reaches allow, each island with
/// what it may touch; methods are not chosen. O(pairs of bodies), some 1e-8 s for each.
std::vector<IslandPlan> findIslands(const Scene& scene);

/// Calls tie(bodyA, bodyB) for every spring, rod, rope, ball joint and hinge; kWorld stands for the world.
template <class Tie>
void forEachLink(const Scene& scene, const Tie& tie) {
  const auto all = [&](const auto& links) {
    for (const auto& link : links) tie(link.anchorA.body, link.anchorB.body);
  };
  all(scene.springs), all(scene.rods), all(scene.ropes), all(scene.ballJoints), all(scene.hinges);
}

}  // namespace cradle
