#pragma once

#include <vector>

#include "scene/scene.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// The clusters of an island of the plan: moving bodies that links tie to each other, with their links and pushes. They
/// are numbered in the order of their first bodies. What is fixed or driven is of none.
class Clusters {
 public:
  /// Keeps references to both. O(bodies of the scene, links and pushes of the island).
  Clusters(const Scene& scene, const IslandPlan& plan);

  std::size_t count() const { return bodies_.size(); }

  /// Of a scene body; -1: none. O(1).
  int of(int sceneBody) const { return sceneBody == kWorld ? -1 : clusterOfBody_[static_cast<std::size_t>(sceneBody)]; }

  /// The part of the plan that is about some clusters, with all that these may touch or hang from and that no forces
  /// move. O(part and fixed and driven bodies, log island).
  IslandPlan partOf(const std::vector<int>& clusters) const;

 private:
  const Scene& scene_;
  const IslandPlan& plan_;
  std::vector<int> clusterOfBody_;                // by scene body
  std::vector<std::vector<int>> bodies_;          // of the scene, ascending; by cluster, as those that follow
  std::vector<std::vector<std::size_t>> links_;   // indices into the plan's
  std::vector<std::vector<std::size_t>> pushes_;  // indices into the scene's
  std::vector<int> fixed_;                        // scene bodies that may be touched, ascending
};

}  // namespace cradle
