#include "simulate/plan/plan_islands.h"

#include <algorithm>
#include <map>

#include "core/interruption.h"
#include "simulate/colliders.h"
#include "simulate/plan/disjoint_sets.h"

namespace cradle {
namespace {

/// What reaches of bodies are compared with: their size around the centre of mass.
double sizeOf(const Body& body, const Scene& scene) {
  const auto collider = colliderOf(body, scene, 0);
  return collider ? collider->boundingRadius : 0;
}

/// A fixed body's collider stands in the world: its size around the place of its frame.
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
    sizes.push_back(body.motion == Motion::dynamic ? sizeOf(body, scene) : fixedSizeOf(body, scene));
  return sizes;
}

bool canMeet(const Reach& a, double sizeA, const Reach& b, double sizeB) {
  return (a.center - b.center).norm() <= a.radius + b.radius + sizeA + sizeB;
}

bool canMeetPlane(const Reach& reach, double size, const Body& plane) {
  const Vec3 normal = plane.worldFromBody.rotation * std::get<Plane>(plane.shape).normal;
  return normal.dot(reach.center - plane.worldFromBody.translation) <= reach.radius + size;
}

/// Bodies that touch something, by body.
std::vector<char> findTouching(const Scene& scene, const ReachablePairs& reachable) {
  std::vector<char> touches(scene.bodies.size(), 0);
  for (int i = 0; i < std::ssize(touches); ++i) {
    throwIfInterrupted();
    for (int j = i + 1; j < std::ssize(touches); ++j) {
      char &first = touches[static_cast<std::size_t>(i)], &second = touches[static_cast<std::size_t>(j)];
      if (!(first && second) && reachable.mayMeet(i, j)) first = second = 1;
    }
  }
  return touches;
}

int movingOr(const Scene& scene, int body) {
  return body != kWorld && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::dynamic ? body : kWorld;
}

/// Moving bodies that depend on each other.
DisjointSets joinIslands(const Scene& scene, const ReachablePairs& reachable) {
  DisjointSets joined(scene.bodies.size());
  forEachLink(scene, [&](int a, int b) { joined.join(movingOr(scene, a), movingOr(scene, b)); });
  for (int i = 0; i < std::ssize(scene.bodies); ++i) {
    throwIfInterrupted();
    for (int j = i + 1; j < std::ssize(scene.bodies); ++j) {
      if (movingOr(scene, i) == kWorld || movingOr(scene, j) == kWorld) continue;
      if (joined.islandOf(i) != joined.islandOf(j) && reachable.mayMeet(i, j)) joined.join(i, j);
    }
  }
  return joined;
}

/// The bodies of an island that may touch, and the fixed ones that they may touch.
std::vector<int> touchingOf(const Scene& scene, const IslandPlan& island, const ReachablePairs& reachable) {
  std::vector<int> touching;
  throwIfInterrupted();
  for (int other = 0; other < std::ssize(scene.bodies); ++other) {
    const bool moves = movingOr(scene, other) != kWorld;
    if (moves && !std::binary_search(island.bodies.begin(), island.bodies.end(), other)) continue;
    const auto meetsOther = [&](int body) { return body != other && reachable.mayMeet(body, other); };
    bool meets = std::any_of(island.bodies.begin(), island.bodies.end(), meetsOther);
    for (int body = 0; moves && !meets && body < std::ssize(scene.bodies); ++body)
      meets = movingOr(scene, body) == kWorld && meetsOther(body);
    if (meets) touching.push_back(other);
  }
  return touching;
}

}  // namespace

ReachablePairs::ReachablePairs(const Scene& scene)
    : scene_(scene), sizes_(sizesOf(scene)), joined_(pairsKeptFromTouching(scene)) {
  std::vector<char> touches(scene.bodies.size(), 0);
  reaches_ = reachOf(scene, touches);
  while (true) {
    const std::vector<char> found = findTouching(scene, *this);
    if (found == touches) return;
    touches = found;
    reaches_ = reachOf(scene, touches);
  }
}

bool ReachablePairs::mayMeet(int first, int second) const {
  const auto i = static_cast<std::size_t>(first), j = static_cast<std::size_t>(second);
  const Body &a = scene_.bodies[i], &b = scene_.bodies[j];
  if (!mayTouch(a, b)) return false;
  const bool meet = std::holds_alternative<Plane>(a.shape)   ? canMeetPlane(reaches_[j], sizes_[j], a)
                    : std::holds_alternative<Plane>(b.shape) ? canMeetPlane(reaches_[i], sizes_[i], b)
                                                             : canMeet(reaches_[i], sizes_[i], reaches_[j], sizes_[j]);
  return meet && (joined_.empty() || !joined_.contains(std::minmax(first, second)));
}

std::vector<IslandPlan> findIslands(const Scene& scene, const ReachablePairs& reachable) {
  const DisjointSets joined = joinIslands(scene, reachable);
  std::map<int, IslandPlan> islands;
  for (int body = 0; body < std::ssize(scene.bodies); ++body)
    if (movingOr(scene, body) != kWorld) islands[joined.islandOf(body)].bodies.push_back(body);
  std::vector<IslandPlan> ordered;
  for (auto& [first, island] : islands) {
    island.touching = touchingOf(scene, island, reachable);
    ordered.push_back(std::move(island));
  }
  return ordered;
}

}  // namespace cradle
