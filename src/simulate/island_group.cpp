#include "simulate/island_group.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "simulate/plan/near_spheres.h"
#include "simulate/plan/plan_islands.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

// Windows, and parts of a body's radius: bodies that come no nearer than that part over so many windows begin as
// islands of their own.
constexpr double kApartWindows = 4, kApartMargin = 0.5;
constexpr double kMeetingMargin = 0.05;  // of a radius: bodies that come nearer within a window are taken to meet
constexpr double kFastRatio = 0.25;      // of the bodies that move: they go farther than their radii in a window
constexpr double kTouchMargin = 1e-6;    // of a radius: far more than tolerances of contact

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

Reach sphereAround(const Bounds& box, double radius) {
  return {box.center(), box.diagonal().norm() / 2 + radius};
}

bool areNear(const Bounds& a, double radiusA, const Bounds& b, double radiusB) {
  const double reach = radiusA + radiusB;
  return a.squaredExteriorDistance(b) <= reach * reach;
}

/// s: until a body that is free has gone its radius.
double timeToGo(double radius, double speed, double gravity) {
  return 2 * radius / (speed + std::sqrt(speed * speed + 2 * gravity * radius));
}

}  // namespace

bool IslandGroup::mayDivide(const Scene& scene, const IslandPlan& plan) {
  if (!plan.method.isAdaptive() || !plan.pushes.empty() || plan.touching.empty()) return false;
  const DisjointSets tied = tiedBodies(scene, plan);
  return std::any_of(plan.bodies.begin(), plan.bodies.end(),
                     [&](int body) { return tied.islandOf(body) != tied.islandOf(plan.bodies.front()); });
}

IslandGroup::IslandGroup(const Scene& scene, const IslandPlan& plan, Assembly all)
    : scene_(scene), plan_(plan), all_(std::move(all)), record_(all_, scene.accuracy) {
  findClusters();
  start_ = {0, all_.state, std::vector<JointState>(all_.joints.size())};
  DisjointSets joined(clusters_.size());
  visitNear(kApartWindows * windowLength(), kApartMargin, [&](int a, int b) { joined.join(a, b); });
  regroup(setsOf(std::move(joined)));
  addWindow(0, {});
}

void IslandGroup::findClusters() {
  const DisjointSets tied = tiedBodies(scene_, plan_);
  std::vector<int> clusterOf(scene_.bodies.size(), -1);
  for (const int body : plan_.bodies) {
    int& cluster = clusterOf[static_cast<std::size_t>(tied.islandOf(body))];
    if (cluster < 0) {
      cluster = static_cast<int>(clusters_.size());
      clusters_.emplace_back();
    }
    clusters_[static_cast<std::size_t>(cluster)].push_back(body);
    clusterOf[static_cast<std::size_t>(body)] = cluster;
  }
  for (const int body : all_.sceneBodies) clusterOfBody_.push_back(clusterOf[static_cast<std::size_t>(body)]);
  linksOfCluster_.resize(clusters_.size());
  for (std::size_t i = 0; i < plan_.links.size(); ++i) {
    const auto [a, b] = anchorsOf(plan_.links[i], scene_);
    const int body = isMoving(scene_, a.body) ? a.body : b.body;
    linksOfCluster_[static_cast<std::size_t>(clusterOf[static_cast<std::size_t>(body)])].push_back(i);
  }
  for (const int body : plan_.touching)
    if (scene_.bodies[static_cast<std::size_t>(body)].motion == Motion::fixed) fixed_.push_back(body);
  islandOfCluster_.resize(clusters_.size());
}

const VectorX& IslandGroup::stateAt(double time, const std::function<void(double time)>& reached) {
  const double until = time - sameTime(time);
  while (frames_.back().time < until) {
    const double length = windowLength();
    mergeThoseThatComeNear(length);
    addWindow(length, reached);
  }
  while (frames_.front().time < until) frames_.pop_front();
  CRADLE_CHECK(frames_.front().time <= time + sameTime(time));  // others are not kept
  record_.add(time, frames_.front().state);
  return frames_.front().state;
}

void IslandGroup::finish() {
  if (const auto loss = record_.firstLoss(); loss && !promiseEnd_) promiseEnd_ = endOf(*loss, all_.sceneBodies, scene_);
}

long IslandGroup::evaluations() const {
  return std::accumulate(islands_.begin(), islands_.end(), evaluations_,
                         [](long sum, const Island& island) { return sum + island.solver->evaluations(); });
}

/// s: in it, most bodies that move go no farther than their radii.
double IslandGroup::windowLength() const {
  const double gravity = all_.mechanism.gravity.norm();
  std::vector<double> times;
  for (std::size_t i = 0; i < clusterOfBody_.size(); ++i) {
    const double speed = linearVelocity(start_.state, static_cast<Eigen::Index>(i)).norm();
    if (clusterOfBody_[i] >= 0 && all_.radii[i] > 0 && speed > 0)
      times.push_back(timeToGo(all_.radii[i], speed, gravity));
  }
  if (times.empty()) return std::min(scene_.duration, timeToGo(smallestSize(all_.geometry), 0, gravity));
  const auto found = times.begin() + static_cast<std::ptrdiff_t>(kFastRatio * static_cast<double>(times.size()));
  std::nth_element(times.begin(), found, times.end());
  return std::min(*found, scene_.duration);
}

/// Moves all islands on by a time (s), or to the end of the scene.
void IslandGroup::addWindow(double length, const std::function<void(double time)>& reached) {
  const double left = scene_.duration - start_.time;
  const double end = length < left * (1 - kTimeRounding) ? start_.time + length : scene_.duration;
  std::function<void(double)> tell;
  if (reached) tell = [&](double) { reached(start_.time); };
  do {
    for (Island& island : islands_)
      if (!island.hasMoved) move(island, end, tell);
  } while (mergeThoseThatMet());
  accept();
}

/// Joins what is about to meet.
void IslandGroup::mergeThoseThatComeNear(double window) {
  DisjointSets joined = islandsNow();
  visitNear(window, kMeetingMargin, [&](int a, int b) { joined.join(a, b); });
  const std::vector<std::vector<int>> sets = setsOf(std::move(joined));
  for (const std::vector<int>& set : sets)
    if (!islandOf(set))
      for (const int cluster : set)
        if (Island& island = islandAt(cluster); island.clusters.front() == cluster) stepToStart(island);
  regroup(sets);
}

/// The clusters of each island, joined.
DisjointSets IslandGroup::islandsNow() const {
  DisjointSets joined(clusters_.size());
  for (const Island& island : islands_)
    for (const int cluster : island.clusters) joined.join(island.clusters.front(), cluster);
  return joined;
}

/// The sets of joined clusters, in the order of their first ones.
std::vector<std::vector<int>> IslandGroup::setsOf(DisjointSets joined) const {
  joined.flatten();
  std::vector<std::vector<int>> sets(clusters_.size());
  for (int cluster = 0; cluster < std::ssize(clusters_); ++cluster)
    sets[static_cast<std::size_t>(joined.islandOf(cluster))].push_back(cluster);
  std::erase_if(sets, [](const std::vector<int>& set) { return set.empty(); });
  return sets;
}

/// The island of just these clusters, if there is one.
std::optional<std::size_t> IslandGroup::islandOf(const std::vector<int>& set) const {
  const std::size_t island = islandOfCluster_[static_cast<std::size_t>(set.front())];
  return island < islands_.size() && islands_[island].clusters == set ? std::optional(island) : std::nullopt;
}

/// The state at the window's start of an island that may be another one from there on is that of a step: no error of an
/// interpolant goes into the motion.
void IslandGroup::stepToStart(Island& island) {
  const VectorX& state = island.solver->stepToReported();
  island.startLedger = state.tail<kLedgerSize>();
  place(island, state, start_.state);
}

void IslandGroup::place(const Island& island, const VectorX& part, VectorX& all) {
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const Eigen::Index from = static_cast<Eigen::Index>(i), to = island.bodies[i];
    all.segment<kPoseSize>(to * kPoseSize) = part.segment<kPoseSize>(from * kPoseSize);
    all.segment<kVelocitySize>(velocityOffset(all, to)) = part.segment<kVelocitySize>(velocityOffset(part, from));
  }
}

/// Visits clusters with bodies that come nearer than a part of their radii in a time (s) of free flight.
void IslandGroup::visitNear(double horizon, double margin, const std::function<void(int, int)>& visit) const {
  std::vector<Bounds> boxes;
  std::vector<double> radii;
  std::vector<int> clusters;
  std::vector<Reach> spheres;
  for (std::size_t i = 0; i < clusterOfBody_.size(); ++i) {
    if (clusterOfBody_[i] < 0 || all_.radii[i] == 0) continue;
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const Vec3 place = centerOfMass(start_.state, body), way = horizon * linearVelocity(start_.state, body);
    Bounds box(place);
    if (way != Vec3::Zero()) {  // a parabola lies between its control points
      box.extend(place + way / 2);
      box.extend(place + way + horizon * horizon / 2 * all_.mechanism.gravity);
    }
    boxes.push_back(box), radii.push_back((1 + margin) * all_.radii[i]), clusters.push_back(clusterOfBody_[i]);
    spheres.push_back(sphereAround(box, radii.back()));
  }
  forEachNearPair(spheres, [&](std::size_t a, std::size_t b) {
    if (clusters[a] != clusters[b] && areNear(boxes[a], radii[a], boxes[b], radii[b])) visit(clusters[a], clusters[b]);
    return true;
  });
}

/// Makes islands of sets of clusters, which begin at the window's start; those that stay as they are go on.
void IslandGroup::regroup(const std::vector<std::vector<int>>& sets) {
  std::vector<std::optional<std::size_t>> same;
  for (const std::vector<int>& set : sets) same.push_back(islandOf(set));
  std::vector<Island> before = std::exchange(islands_, {});
  for (std::size_t i = 0; i < sets.size(); ++i)
    islands_.push_back(same[i] ? std::move(before[*same[i]]) : makeIsland(sets[i], before));
  for (const Island& old : before) {
    if (!old.solver) continue;
    settled_ += old.startLedger;
    evaluations_ += old.solver->evaluations();
  }
  for (std::size_t i = 0; i < islands_.size(); ++i)
    for (const int cluster : islands_[i].clusters) islandOfCluster_[static_cast<std::size_t>(cluster)] = i;
}

/// The part of the plan that is about some clusters, with all that they may touch and that does not move by forces.
IslandPlan IslandGroup::planOf(const std::vector<int>& clusters) const {
  IslandPlan part;
  std::vector<std::size_t> links;
  part.touching = fixed_;
  const auto add = [](const std::vector<int>& from, std::vector<int>& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const int cluster : clusters) {
    add(clusters_[static_cast<std::size_t>(cluster)], part.bodies);
    const std::vector<std::size_t>& tied = linksOfCluster_[static_cast<std::size_t>(cluster)];
    links.insert(links.end(), tied.begin(), tied.end());
  }
  const auto mayTouch = [this](int body) {
    return std::binary_search(plan_.touching.begin(), plan_.touching.end(), body);
  };
  std::copy_if(part.bodies.begin(), part.bodies.end(), std::back_inserter(part.touching), mayTouch);
  std::sort(links.begin(), links.end());
  std::vector<char> isTied(scene_.bodies.size(), 0);
  for (const std::size_t link : links) {
    part.links.push_back(plan_.links[link]);
    const auto [a, b] = anchorsOf(plan_.links[link], scene_);
    for (const int body : {a.body, b.body})
      if (body != kWorld) isTied[static_cast<std::size_t>(body)] = 1;
  }
  for (const int body : plan_.driven)
    if (mayTouch(body) || isTied[static_cast<std::size_t>(body)]) part.driven.push_back(body);
  std::copy_if(part.driven.begin(), part.driven.end(), std::back_inserter(part.touching), mayTouch);
  std::sort(part.bodies.begin(), part.bodies.end());
  std::sort(part.touching.begin(), part.touching.end());
  part.nonRotating = plan_.nonRotating;
  part.method = plan_.method;
  return part;
}

IslandGroup::Island IslandGroup::makeIsland(const std::vector<int>& clusters, const std::vector<Island>& before) {
  Island island;
  island.clusters = clusters;
  Assembly assembly = assemble(scene_, planOf(clusters));
  VectorX state = assembly.state;
  for (std::size_t i = 0; i < assembly.sceneBodies.size(); ++i) {
    const int from = indexAmong(all_.sceneBodies, assembly.sceneBodies[i]);
    const Eigen::Index to = static_cast<Eigen::Index>(i);
    island.bodies.push_back(from);
    state.segment<kPoseSize>(to * kPoseSize) = start_.state.segment<kPoseSize>(from * kPoseSize);
    state.segment<kVelocitySize>(velocityOffset(state, to)) =
        start_.state.segment<kVelocitySize>(velocityOffset(start_.state, from));
  }
  std::vector<JointState> joints;
  for (const AssembledJoint& joint : assembly.joints) {
    const auto found = std::find_if(all_.joints.begin(), all_.joints.end(),
                                    [&](const AssembledJoint& other) { return other.index == joint.index; });
    island.joints.push_back(static_cast<std::size_t>(found - all_.joints.begin()));
    joints.push_back(start_.joints[island.joints.back()]);
  }
  beginAt(start_.time, state, joints, assembly);

  std::optional<PromiseEnd> end;
  for (const Island& old : before) {
    if (std::none_of(old.clusters.begin(), old.clusters.end(),
                     [&](int cluster) { return std::binary_search(clusters.begin(), clusters.end(), cluster); }))
      continue;
    if (const auto& given = old.promiseEndAtStart; given && !end) end = given;
  }
  island.promiseEndAtStart = end;
  island.solver = std::make_unique<IslandSolver>(scene_, std::move(assembly), plan_.method, end);
  island.solver->stateAt(start_.time);
  if (start_.time > 0) island.solver->takeEvents();  // they have been told, of the islands before
  return island;
}

/// Through the window that begins now. A fault may be one of a step that other bodies would have ended.
void IslandGroup::move(Island& island, double end, const std::function<void(double time)>& reached) const {
  island.hasMoved = true;
  const auto add = [&](double time) {
    const VectorX& state = island.solver->stateAt(time, reached);
    island.snapshots.push_back({time, state, island.solver->jointStates()});
  };
  try {
    island.solver->beginSweep(end);
    for (long frame = nextFrame_; frame <= lastFrame(scene_); ++frame) {
      const double time = frameTime(scene_, frame);
      if (time > end + sameTime(end)) break;
      add(time);
    }
    add(end);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::interrupted) throw;
    island.fault = std::current_exception();
  }
  const std::vector<Event> events = island.solver->takeEvents();
  island.events.insert(island.events.end(), events.begin(), events.end());
}

/// True if bodies of different islands may have met in the window: these islands are one now, at its start.
bool IslandGroup::mergeThoseThatMet() {
  if (islands_.size() == 1) return false;
  std::vector<Reach> spheres;
  std::vector<const Bounds*> boxes;
  std::vector<double> radii;
  std::vector<int> clusters;
  for (const Island& island : islands_)
    for (std::size_t i = 0; i < island.bodies.size(); ++i) {
      const auto body = static_cast<std::size_t>(island.bodies[i]);
      if (clusterOfBody_[body] < 0 || all_.radii[body] == 0) continue;
      boxes.push_back(&island.solver->swept().centers()[i]);
      radii.push_back((1 + kTouchMargin) * all_.radii[body]);
      clusters.push_back(clusterOfBody_[body]);
      spheres.push_back(sphereAround(*boxes.back(), radii.back()));
    }
  DisjointSets joined = islandsNow();
  bool isAny = false;
  forEachNearPair(spheres, [&](std::size_t a, std::size_t b) {
    const auto islandOf = [&](std::size_t i) { return islandOfCluster_[static_cast<std::size_t>(clusters[i])]; };
    if (islandOf(a) == islandOf(b) || !areNear(*boxes[a], radii[a], *boxes[b], radii[b])) return true;
    joined.join(clusters[a], clusters[b]);
    isAny = true;
    return true;
  });
  if (!isAny) return false;
  regroup(setsOf(std::move(joined)));
  return true;
}

/// The motion of all islands through the window counts.
void IslandGroup::accept() {
  for (const Island& island : islands_)
    if (island.fault) std::rethrow_exception(island.fault);
  const std::size_t count = islands_.front().snapshots.size();
  for (std::size_t i = 0; i + 1 < count; ++i, ++nextFrame_) frames_.push_back(gather(i));
  start_ = gather(count - 1);
  record_.measure(start_.state);
  const double until = start_.time + sameTime(start_.time);
  for (Island& island : islands_) {
    island.startLedger = island.snapshots.back().state.tail<kLedgerSize>();
    island.snapshots.clear();
    island.hasMoved = false;
    const auto later = std::stable_partition(island.events.begin(), island.events.end(),
                                             [&](const Event& event) { return event.time <= until; });
    events_.insert(events_.end(), island.events.begin(), later);
    island.events.erase(island.events.begin(), later);
    for (std::string& warning : island.solver->takeWarnings()) warnings_.push_back(std::move(warning));
    corrections_.take(island.solver->corrections());
    island.promiseEndAtStart = island.solver->promiseEnd();
    if (const auto& end = island.promiseEndAtStart; end && (!promiseEnd_ || end->time < promiseEnd_->time))
      promiseEnd_ = end;
  }
}

/// All bodies at one of the islands' snapshots.
IslandGroup::Snapshot IslandGroup::gather(std::size_t number) const {
  Snapshot all{islands_.front().snapshots[number].time, start_.state, start_.joints};
  all.state.tail<kLedgerSize>() = settled_;
  for (const Island& island : islands_) {
    const Snapshot& part = island.snapshots[number];
    place(island, part.state, all.state);
    all.state.tail<kLedgerSize>() += part.state.tail<kLedgerSize>();
    for (std::size_t i = 0; i < island.joints.size(); ++i) all.joints[island.joints[i]] = part.joints[i];
  }
  return all;
}

}  // namespace cradle
