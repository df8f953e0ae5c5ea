#include "simulate/clusters.h"

#include <algorithm>

#include "constraints/disjoint_sets.h"
#include "simulate/plan/plan_islands.h"

namespace cradle {
namespace {

bool isMoving(const Scene& scene, int body) {
  return body != kWorld && scene.bodies[static_cast<std::size_t>(body)].motion == Motion::dynamic;
}

/// Sets of moving scene bodies that links tie to each other.
DisjointSets tiedBodies(const Scene& scene, const IslandPlan& plan) {
  DisjointSets tied(scene.bodies.size());
  for (const LinkIndex& link : plan.links) {
    const auto [a, b] = anchorsOf(link, scene);
    if (isMoving(scene, a.body) && isMoving(scene, b.body)) tied.join(a.body, b.body);
  }
  tied.flatten();
  return tied;
}

bool isAmong(const std::vector<int>& ascending, int body) {
  return std::binary_search(ascending.begin(), ascending.end(), body);
}

}  // namespace

Clusters::Clusters(const Scene& scene, const IslandPlan& plan)
    : scene_(scene), plan_(plan), clusterOfBody_(scene.bodies.size(), -1) {
  const DisjointSets tied = tiedBodies(scene, plan);
  for (const int body : plan.bodies) {
    int& cluster = clusterOfBody_[static_cast<std::size_t>(tied.islandOf(body))];
    if (cluster < 0) {
      cluster = static_cast<int>(bodies_.size());
      bodies_.emplace_back();
    }
    bodies_[static_cast<std::size_t>(cluster)].push_back(body);
    clusterOfBody_[static_cast<std::size_t>(body)] = cluster;
  }
  links_.resize(count()), pushes_.resize(count());
  for (std::size_t i = 0; i < plan.links.size(); ++i) {
    const auto [a, b] = anchorsOf(plan.links[i], scene);
    links_[static_cast<std::size_t>(of(isMoving(scene, a.body) ? a.body : b.body))].push_back(i);
  }
  for (const std::size_t push : plan.pushes)
    pushes_[static_cast<std::size_t>(of(scene.pushes[push].body))].push_back(push);
  for (const int body : plan.touching)
    if (scene.bodies[static_cast<std::size_t>(body)].motion == Motion::fixed) fixed_.push_back(body);
}

IslandPlan Clusters::partOf(const std::vector<int>& clusters) const {
  IslandPlan part;
  std::vector<std::size_t> links;
  const auto add = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  for (const int cluster : clusters) {
    add(bodies_[static_cast<std::size_t>(cluster)], part.bodies);
    add(links_[static_cast<std::size_t>(cluster)], links);
    add(pushes_[static_cast<std::size_t>(cluster)], part.pushes);
  }
  std::sort(part.bodies.begin(), part.bodies.end());
  std::sort(links.begin(), links.end());
  std::sort(part.pushes.begin(), part.pushes.end());

  std::vector<int> tied;
  for (const std::size_t link : links) {
    part.links.push_back(plan_.links[link]);
    const auto [a, b] = anchorsOf(plan_.links[link], scene_);
    tied.insert(tied.end(), {a.body, b.body});
  }
  std::sort(tied.begin(), tied.end());
  for (const int body : plan_.driven)
    if (isAmong(plan_.touching, body) || isAmong(tied, body)) part.driven.push_back(body);

  part.touching = fixed_;
  for (const auto* bodies : {&part.bodies, &part.driven})
    std::copy_if(bodies->begin(), bodies->end(), std::back_inserter(part.touching),
                 [this](int body) { return isAmong(plan_.touching, body); });
  std::sort(part.touching.begin(), part.touching.end());
  std::copy_if(part.bodies.begin(), part.bodies.end(), std::back_inserter(part.nonRotating),
               [this](int body) { return isAmong(plan_.nonRotating, body); });
  part.method = plan_.method;
  return part;
}

}  // namespace cradle
