#pragma once

#include "constraints/disjoint_sets.h"
#include "scene/scene.h"

namespace cradle {

/// Which bodies of a scene welds make one, from one to the next. They do not touch each other: nothing could part them
/// or press them together, and parts of one body may overlap. All that is fixed is one body.
class WeldedBodies {
 public:
  explicit WeldedBodies(const Scene& scene);

  /// The same for two scene bodies if they are one. O(1).
  int groupOf(int body) const { return sets_.islandOf(placeOf(body)); }

  /// Of two different scene bodies.
  bool areOne(int first, int second) const { return !scene_.welds.empty() && groupOf(first) == groupOf(second); }

 private:
  int placeOf(int body) const;

  const Scene& scene_;
  DisjointSets sets_;  // by scene body, that of what is fixed behind them
};

}  // namespace cradle
