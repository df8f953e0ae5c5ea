#pragma once

#include <functional>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "simulate/plan/plan.h"
#include "simulate/plan/reach.h"
#include "simulate/welded_bodies.h"

namespace cradle {

/// Pairs of bodies that may touch each other: their reaches overlap. A body that touches another may be thrown anywhere
/// that its constraints allow, so that its reach is that of constraints alone.
class ReachablePairs {
 public:
  /// Keeps a reference to `scene`. Costs as forEachReachablePair does, a few times.
  explicit ReachablePairs(const Scene& scene);

  bool mayCollide(int first, int second) const;

  using Visit = std::function<bool(int first, int second)>;
  /// Calls visit for pairs (first < second) that may collide, until it returns false: all of them, or, where a body
  /// moves without bounds, enough to tell which bodies touch another and what islands follow, as all that collide with
  /// it are one island. O(bodies) then, else as sweep and prune.
  void forEachReachablePair(const Visit& visit) const;

  /// A moving body whose reach is infinite, so that it may collide with all others, but those that joints keep from it.
  std::optional<int> boundless() const;

 private:
  const Body& bodyAt(int body) const { return scene_.bodies[static_cast<std::size_t>(body)]; }
  bool visitAll(int body, const Visit& visit) const;
  bool isKeptFrom(int first, int second) const;
  void visitBounded(const Visit& visit) const;

  const Scene& scene_;
  std::vector<Reach> reaches_;  // by body
  std::vector<double> sizes_;   // m, by body
  std::set<std::pair<int, int>> joined_;
  WeldedBodies welded_;
  std::vector<int> colliding_, planes_;  // bodies that may touch something, ascending
};

/// Islands: moving bodies that depend on each other by constraints, springs or contact that their reaches allow, each
/// island with the bodies that may touch. Their methods are not chosen yet.
std::vector<IslandPlan> findIslands(const Scene& scene, const ReachablePairs& reachable);

/// Calls visit(link, anchorA, anchorB) for every link; `link` is its LinkIndex.
template <class Visit>
void forEachLink(const Scene& scene, const Visit& visit) {
  forEachKindOfLink(scene, [&](const auto& links) {
    constexpr LinkKind kind = LinkOf<decltype(links)>::kKind;
    for (std::size_t i = 0; i < links.size(); ++i) visit(LinkIndex{kind, i}, links[i].anchorA, links[i].anchorB);
  });
}

/// Both anchors of a link.
std::pair<Anchor, Anchor> anchorsOf(const LinkIndex& link, const Scene& scene);

}  // namespace cradle
