#pragma once

#include <utility>
#include <vector>

#include "constraints/disjoint_sets.h"

namespace cradle {

/// The two sides of mirror images among islands in time: of clusters that islands have connected, at one time or one
/// after the other (of one origin), those whose events differ in time by rounding alone. As islands of their own both
/// sides locate each event for themselves, and would drift apart tenfold at each impact, until they meet one after the
/// other what they should meet at once.
class Twins {
 public:
  explicit Twins(std::size_t clusters) : origins_(clusters), together_(clusters) {}

  /// Such as others have come to: for each cluster one that it is joined with.
  Twins(const std::vector<int>& origins, const std::vector<int>& together);

  /// To be told the clusters of each island.
  void connect(const std::vector<int>& clusters);

  /// An event (s) of a cluster that is in an island now.
  struct Instant {
    double time;
    int cluster;
    std::size_t island;
  };

  /// Pairs of clusters of different islands that are found to be twins; from now on they are not to part. Times of
  /// equal bits show no difference yet. O(n log n).
  std::vector<std::pair<int, int>> find(const std::vector<Instant>& events);

  /// Clusters that are not to part, joined.
  const DisjointSets& together() const { return together_; }
  const DisjointSets& origins() const { return origins_; }

 private:
  DisjointSets origins_, together_;
};

}  // namespace cradle
