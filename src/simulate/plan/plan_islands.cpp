#include "simulate/plan/plan_islands.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "constraints/disjoint_sets.h"
#include "core/interruption.h"
#include "simulate/colliders.h"
#include "simulate/plan/near_spheres.h"

namespace cradle {
namespace {

/// m: radius of a body's bounding sphere about its centre of mass, by which its reach is widened.
double sizeOf(const Body& body, const Scene& scene) {
  const auto collider = colliderOf(body, scene, 0);
  return collider ? collider->boundingRadius : 0;
}

/// m: radius of a fixed body's bounding sphere about the origin of its frame, where its reach has its centre.
double fixedSizeOf(const Body& body, const Scene& scene) {
  const auto collider = colliderOf(body, scene, -1);
  double size = 0;
  if (!collider) return size;
  for (const Vec3& point : collider->points)
    size = std::max(size, (point - body.worldFromBody.translation).norm() + collider->radius + collider->rimRadius);
  return size;
}

std::vector<double> sizesOf(const Scene& scene) {
  std::vector<double> sizes;
  for (const Body& body : scene.bodies)
    sizes.push_back(body.motion == Motion::fixed ? fixedSizeOf(body, scene) : sizeOf(body, scene));
  return sizes;
}

bool canReach(const Reach& a, double sizeA, const Reach& b, double sizeB) {
  return (a.center - b.center).norm() <= a.radius + b.radius + sizeA + sizeB;
}

bool canReachPlane(const Reach& reach, double size, const Body& plane) {
  const Vec3 normal = plane.worldFromBody.rotation * std::get<Plane>(plane.shape).normal;
  return normal.dot(reach.center - plane.worldFromBody.translation) <= reach.radius + size;
}

/// Whether a body may touch another, by body.
std::vector<char> findTouching(const Scene& scene, const ReachablePairs& reachable) {
  std::vector<char> touches(scene.bodies.size(), 0);
  std::ptrdiff_t left = std::ssize(touches);
  reachable.forEachReachablePair([&](int i, int j) {
    for (const int body : {i, j}) left -= std::exchange(touches[static_cast<std::size_t>(body)], char{1}) == 0;
    return left > 0;
  });
  return touches;
}

/// Each once, ascending.
void sortOut(std::vector<int>& bodies) {
  std::sort(bodies.begin(), bodies.end());
  bodies.erase(std::unique(bodies.begin(), bodies.end()), bodies.end());
}

bool isDriven(int body, const Scene& scene) {
  return body != kWorld && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::driven;
}

int movingOr(const Scene& scene, int body) {
  return body != kWorld && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::dynamic ? body : kWorld;
}

/// Sets of moving bodies that depend on each other.
DisjointSets joinIslands(const Scene& scene, const ReachablePairs& reachable) {
  DisjointSets joined(scene.bodies.size());
  forEachLink(scene, [&](const LinkIndex&, const Anchor& a, const Anchor& b) {
    joined.join(movingOr(scene, a.body), movingOr(scene, b.body));
  });
  reachable.forEachReachablePair([&](int i, int j) {
    joined.join(movingOr(scene, i), movingOr(scene, j));
    return true;
  });
  joined.flatten();
  return joined;
}

/// For the first body of each island: the island's bodies that may touch, and the fixed ones that they may touch;
/// ascending.
std::vector<std::vector<int>> findTouchingByIsland(const Scene& scene, const DisjointSets& joined,
                                                   const ReachablePairs& reachable) {
  std::vector<std::vector<int>> touching(scene.bodies.size());
  reachable.forEachReachablePair([&](int i, int j) {
    const int moving = movingOr(scene, i) != kWorld ? i : j;
    std::vector<int>& ofIsland = touching[static_cast<std::size_t>(joined.islandOf(moving))];
    ofIsland.push_back(i), ofIsland.push_back(j);
    return true;
  });
  for (std::vector<int>& bodies : touching) sortOut(bodies);
  return touching;
}

}  // namespace

ReachablePairs::ReachablePairs(const Scene& scene)
    : scene_(scene), sizes_(sizesOf(scene)), joined_(pairsKeptFromTouching(scene)), welded_(scene) {
  for (int body = 0; body < std::ssize(scene.bodies); ++body)
    if (bodyAt(body).collision != CollisionChoice::none)
      (std::holds_alternative<Plane>(bodyAt(body).shape) ? planes_ : colliding_).push_back(body);
  std::vector<char> touches(scene.bodies.size(), 0);
  reaches_ = reachOf(scene, touches);
  while (true) {
    const std::vector<char> found = findTouching(scene, *this);
    if (found == touches) return;
    touches = found;
    reaches_ = reachOf(scene, touches);
  }
}

bool ReachablePairs::mayCollide(int first, int second) const {
  const auto i = static_cast<std::size_t>(first), j = static_cast<std::size_t>(second);
  const Body &a = scene_.bodies[i], &b = scene_.bodies[j];
  if (!mayTouch(a, b)) return false;
  const bool meet = std::holds_alternative<Plane>(a.shape)   ? canReachPlane(reaches_[j], sizes_[j], a)
                    : std::holds_alternative<Plane>(b.shape) ? canReachPlane(reaches_[i], sizes_[i], b)
                                                             : canReach(reaches_[i], sizes_[i], reaches_[j], sizes_[j]);
  return meet && !isKeptFrom(first, second);
}

bool ReachablePairs::isKeptFrom(int first, int second) const {
  return welded_.areOne(first, second) || (!joined_.empty() && joined_.contains(std::minmax(first, second)));
}

/// Of moving bodies with an infinite reach the one from which joints keep the fewest others.
std::optional<int> ReachablePairs::boundless() const {
  std::map<int, int> kept;
  for (const auto& [a, b] : joined_) ++kept[a], ++kept[b];
  const auto keptFrom = [&](int body) { return kept.contains(body) ? kept.at(body) : 0; };
  std::optional<int> best;
  for (const int body : colliding_)
    if (bodyAt(body).motion == Motion::dynamic && std::isinf(reaches_[static_cast<std::size_t>(body)].radius) &&
        (!best || keptFrom(body) < keptFrom(*best)))
      best = body;
  return best;
}

/// Visits the pairs of one body with all others. False if a visit returned false.
bool ReachablePairs::visitAll(int body, const Visit& visit) const {
  throwIfInterrupted();
  for (const std::vector<int>* bodies : {&colliding_, &planes_})
    for (const int other : *bodies)
      if (other != body && mayCollide(body, other) && !visit(std::min(body, other), std::max(body, other)))
        return false;
  return true;
}

void ReachablePairs::forEachReachablePair(const Visit& visit) const {
  const std::optional<int> hub = boundless();
  if (!hub) return visitBounded(visit);
  if (!visitAll(*hub, visit)) return;
  for (const std::vector<int>* bodies : {&colliding_, &planes_})
    for (const int kept : *bodies)
      if (kept != *hub && isKeptFrom(*hub, kept) && !visitAll(kept, visit)) return;
}

/// Sweep and prune along x, in cells across it.
void ReachablePairs::visitBounded(const Visit& visit) const {
  for (const int plane : planes_)
    if (!visitAll(plane, visit)) return;
  std::vector<Reach> spheres;
  for (const int body : colliding_) {
    const auto i = static_cast<std::size_t>(body);
    spheres.push_back({reaches_[i].center, reaches_[i].radius + sizes_[i]});
  }
  forEachNearPair(spheres, [&](std::size_t i, std::size_t j) {
    const auto [first, second] = std::minmax({colliding_[i], colliding_[j]});
    return !mayCollide(first, second) || visit(first, second);
  });
}

std::pair<Anchor, Anchor> anchorsOf(const LinkIndex& link, const Scene& scene) {
  std::pair<Anchor, Anchor> anchors;
  forEachKindOfLink(scene, [&](const auto& links) {
    if (LinkOf<decltype(links)>::kKind == link.kind) anchors = {links[link.index].anchorA, links[link.index].anchorB};
  });
  return anchors;
}

std::vector<IslandPlan> findIslands(const Scene& scene, const ReachablePairs& reachable) {
  const DisjointSets joined = joinIslands(scene, reachable);
  std::vector<std::vector<int>> touching = findTouchingByIsland(scene, joined, reachable);
  std::map<int, IslandPlan> islands;
  for (int body = 0; body < std::ssize(scene.bodies); ++body)
    if (movingOr(scene, body) != kWorld) islands[joined.islandOf(body)].bodies.push_back(body);
  forEachLink(scene, [&](const LinkIndex& link, const Anchor& a, const Anchor& b) {
    const int moving = movingOr(scene, a.body) != kWorld ? a.body : movingOr(scene, b.body);
    if (moving == kWorld) return;
    IslandPlan& island = islands.at(joined.islandOf(moving));
    island.links.push_back(link);
    for (const int body : {a.body, b.body})
      if (isDriven(body, scene)) island.driven.push_back(body);
  });
  for (std::size_t i = 0; i < scene.pushes.size(); ++i)
    if (const int body = movingOr(scene, scene.pushes[i].body); body != kWorld)
      islands.at(joined.islandOf(body)).pushes.push_back(i);
  std::vector<IslandPlan> ordered;
  for (auto& [first, island] : islands) {
    island.touching = std::move(touching[static_cast<std::size_t>(first)]);
    for (const int body : island.touching)
      if (isDriven(body, scene)) island.driven.push_back(body);
    sortOut(island.driven);
    ordered.push_back(std::move(island));
  }
  return ordered;
}

}  // namespace cradle
