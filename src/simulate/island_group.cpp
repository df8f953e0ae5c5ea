#include "simulate/island_group.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/error.h"
#include "simulate/life_sign.h"
#include "simulate/plan/near_spheres.h"
#include "simulate/shared_islands.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

// Windows, and parts of a body's radius: bodies that come no nearer than that part over so many windows are islands of
// their own.
constexpr double kApartWindows = 4, kApartMargin = 0.5;
constexpr double kMeetingMargin = 0.05;      // of a radius: bodies that come nearer within a window are taken to meet
constexpr double kFastRatio = 0.25;          // of the bodies that move: they go farther than their radii in a window
constexpr double kPartingEvaluations = 100;  // of equations in a window: some eight steps
constexpr double kMaxStretch = 16;           // of windows, while there is one island
constexpr double kShortestRatio = 1e-6;      // of the longest window: faster bodies go farther than their radii in one
constexpr double kStretchedRatio = 1e-4;     // of it: while nothing comes near, windows of fast bodies are as long
constexpr std::size_t kManyIslands = 1000;   // of more, 3 kB each of steps' stages are freed between windows
constexpr long kMaxFrames = 100;             // in a window, each of which is kept until it counts
constexpr double kTouchMargin = 1e-6;        // of a radius: far more than tolerances of contact

Reach sphereAround(const Bounds& box, double radius) {
  return {box.center(), box.diagonal().norm() / 2 + radius};
}

bool areNear(const Bounds& a, double radiusA, const Bounds& b, double radiusB) {
  const double reach = radiusA + radiusB;
  return a.squaredExteriorDistance(b) <= reach * reach;
}

/// The earlier of two ends of promises, with the bodies of both.
PromiseEnd bothOf(const PromiseEnd& a, const PromiseEnd& b) {
  PromiseEnd both = a.time <= b.time ? a : b;
  both.bodies = a.bodies;
  both.bodies.insert(both.bodies.end(), b.bodies.begin(), b.bodies.end());
  std::sort(both.bodies.begin(), both.bodies.end());
  both.bodies.erase(std::unique(both.bodies.begin(), both.bodies.end()), both.bodies.end());
  return both;
}

/// s: until a body that is free has gone its radius.
double timeToGo(double radius, double speed, double gravity) {
  return 2 * radius / (speed + std::sqrt(speed * speed + 2 * gravity * radius));
}

}  // namespace

bool IslandGroup::mayDivide(const Scene& scene, const IslandPlan& plan) {
  if (!plan.method.isAdaptive() || plan.touching.empty()) return false;
  return Clusters(scene, plan).count() > 1;
}

IslandGroup::IslandGroup(const Scene& scene, const IslandPlan& plan, Assembly all, WorkerThreads& threads)
    : scene_(scene),
      plan_(plan),
      threads_(threads),
      all_(std::move(all)),
      record_(all_, scene.accuracy),
      clusters_(scene, plan),
      islandOfCluster_(clusters_.count()),
      twins_(clusters_.count()),
      lastStepEnd_(scene.duration),
      isToldResting_(scene.bodies.size(), 0) {
  for (const int body : all_.sceneBodies) clusterOfBody_.push_back(clusters_.of(body));
  start_ = {0, all_.state, std::vector<JointState>(all_.joints.size()), {}};
  DisjointSets joined(clusters_.count());
  visitNear(kApartWindows * windowLength(), kApartMargin, [&](int a, int b) { return joined.join(a, b), true; });
  regroup(setsOf(std::move(joined)));
  addWindow(0, {});
  tellsContacts_ = false;
}

IslandGroup::IslandGroup(const Scene& scene, const IslandPlan& plan, Assembly all, WorkerThreads& threads,
                         const GroupRecord& record, long frame, double time)
    : scene_(scene),
      plan_(plan),
      threads_(threads),
      all_(std::move(all)),
      record_(all_, scene.accuracy, record.island.measures),
      clusters_(scene, plan),
      islandOfCluster_(clusters_.count()),
      twins_(record.origins, record.together),
      stretch_(record.stretch),
      lastStepEnd_(scene.duration),
      start_{time, record.island.state, record.island.joints, {}},
      tellsContacts_(false),
      settled_(record.island.state.tail<kLedgerSize>()),
      nextFrame_(frame + 1),
      isToldResting_(scene.bodies.size(), 0),
      promiseEnd_(record.promiseEnd) {
  for (const int body : all_.sceneBodies) clusterOfBody_.push_back(clusters_.of(body));
  frames_.push_back(start_);
  for (const PartRecord& part : record.island.parts) {
    for (const int cluster : part.clusters) islandOfCluster_[static_cast<std::size_t>(cluster)] = islands_.size();
    const IslandPlan moved = clusters_.partOf(part.clusters);
    std::vector<int> sceneBodies = moved.bodies;
    sceneBodies.insert(sceneBodies.end(), moved.driven.begin(), moved.driven.end());
    std::sort(sceneBodies.begin(), sceneBodies.end());
    addResting(part, sceneBodies, isToldResting_);
    islands_.push_back(makeIsland(part));
  }
}

double IslandGroup::clock() const {
  double latest = start_.time;
  for (const Island& island : islands_) latest = std::max(latest, island.solver->clock());
  return latest;
}

void IslandGroup::stopAt(double time) {
  lastStepEnd_ = time;
  for (Island& island : islands_) island.solver->stopAt(time);
}

GroupRecord IslandGroup::record() const {
  CRADLE_CHECK(frames_.size() == 1 && clock() <= start_.time + sameTime(start_.time));
  GroupRecord record{{start_.state, start_.joints, {}, record_.measures()}, {}, {}, promiseEnd_, stretch_};
  for (const Island& island : islands_) {
    record.island.parts.push_back(island.solver->partRecord());
    record.island.parts.back().clusters = island.clusters;
  }
  for (int cluster = 0; cluster < static_cast<int>(clusters_.count()); ++cluster) {
    record.origins.push_back(twins_.origins().islandOf(cluster));
    record.together.push_back(twins_.together().islandOf(cluster));
  }
  return record;
}

long IslandGroup::work() const {
  return std::accumulate(islands_.begin(), islands_.end(), work_,
                         [](long sum, const Island& island) { return sum + island.solver->work(); });
}

const VectorX& IslandGroup::stateAt(double time, const std::function<void(double time)>& reached) {
  const double until = time - sameTime(time);
  while (frames_.back().time < until) {
    if (fault_) std::rethrow_exception(fault_);
    const double length = windowLength();
    if (islands_.size() == 1 && !mayPart()) {
      stretch_ = std::min(2 * stretch_, kMaxStretch);
    } else {
      regroupFor(length);
      const double stretch = std::min(2 * stretch_, kStretchedRatio * longestWindow() / length);
      stretch_ = stretch > 1 && stayApart(stretch * length) ? stretch : 1;
    }
    addWindow(std::min(stretch_ * length, longestWindow()), reached);
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

/// s
double IslandGroup::longestWindow() const {
  return std::min(scene_.duration, frameTime(scene_, kMaxFrames));
}

/// s: the time in which three of four bodies that move go no farther than their radii, within kShortestRatio and
/// kMaxFrames.
double IslandGroup::windowLength() const {
  const double longest = longestWindow();
  const double gravity = all_.mechanism.gravity.norm();
  std::vector<double> times;
  for (std::size_t i = 0; i < clusterOfBody_.size(); ++i) {
    const double speed = linearVelocity(start_.state, static_cast<Eigen::Index>(i)).norm();
    if (clusterOfBody_[i] >= 0 && all_.radii[i] > 0 && speed > 0)
      times.push_back(timeToGo(all_.radii[i], speed, gravity));
  }
  if (times.empty()) return std::min(longest, timeToGo(all_.smallestSize, 0, gravity));
  const auto found = times.begin() + static_cast<std::ptrdiff_t>(kFastRatio * static_cast<double>(times.size()));
  std::nth_element(times.begin(), found, times.end());
  return std::clamp(*found, kShortestRatio * longest, longest);
}

/// Moves all islands on by a time (s), or to the end of the scene.
void IslandGroup::addWindow(double length, const std::function<void(double time)>& reached) {
  const double left = lastStepEnd_ - start_.time;
  const double end = length < left * (1 - kTimeRounding) ? start_.time + length : lastStepEnd_;
  std::function<void(double)> tell;
  if (reached) tell = [&](double) { reached(start_.time); };
  do {
    moveAll(end, tell);
  } while (mergeThoseThatMet() || takeBackWhatEndsBeyond(end));
  accept();
}

/// Moves the islands that have not moved through the window yet.
void IslandGroup::moveAll(double end, const std::function<void(double time)>& reached) {
  std::vector<Island*> waiting;
  for (Island& island : islands_)
    if (!island.hasMoved) waiting.push_back(&island);
  const std::vector<double> times = timesUntil(end);
  const SharedLifeSign signs(reached);
  shareIslands(threads_, waiting.size(), evaluationsOfWindow_,
               [&](int thread, std::size_t i) { move(*waiting[i], times, signs.ofThread(thread)); });
  for (const Island* island : waiting)
    if (island->failure) std::rethrow_exception(island->failure);
}

/// Joins what is about to meet, and parts what stays apart.
void IslandGroup::regroupFor(double window) {
  DisjointSets joined = mayPart() ? nearWithinIslands(kApartWindows * window) : islandsNow();
  visitNear(window, kMeetingMargin, [&](int a, int b) { return joined.join(a, b), true; });
  const std::vector<std::vector<int>> sets = setsOf(std::move(joined));
  for (const std::vector<int>& set : sets)
    if (!islandOf(set))
      for (const int cluster : set)
        if (Island& island = islandAt(cluster); island.clusters.front() == cluster) stepToStart(island);
  regroup(sets);
}

bool IslandGroup::mayPart() const {
  return std::any_of(islands_.begin(), islands_.end(), [this](const Island& island) { return isWorthParting(island); });
}

/// To begin anew costs an island some steps.
bool IslandGroup::isWorthParting(const Island& island) const {
  const double evaluations = static_cast<double>(island.evaluationsOfWindow) / stretch_;
  return island.clusters.size() > 1 && evaluations > kPartingEvaluations;
}

/// Clusters of one island that do not stay apart over a time (s), or are not to part, joined.
DisjointSets IslandGroup::nearWithinIslands(double horizon) const {
  DisjointSets joined = twins_.together();
  visitNear(horizon, kApartMargin, [&](int a, int b) {
    if (islandIndexOf(a) == islandIndexOf(b)) joined.join(a, b);
    return true;
  });
  for (const Island& island : islands_)
    if (!isWorthParting(island))
      for (const int cluster : island.clusters) joined.join(island.clusters.front(), cluster);
  return joined;
}

/// The clusters of each island, joined.
DisjointSets IslandGroup::islandsNow() const {
  DisjointSets joined(clusters_.count());
  for (const Island& island : islands_)
    for (const int cluster : island.clusters) joined.join(island.clusters.front(), cluster);
  return joined;
}

/// The sets of joined clusters, in the order of their first ones.
std::vector<std::vector<int>> IslandGroup::setsOf(DisjointSets joined) const {
  joined.flatten();
  std::vector<std::vector<int>> sets(clusters_.count());
  for (int cluster = 0; cluster < static_cast<int>(clusters_.count()); ++cluster)
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

/// Visits clusters with bodies that come nearer than a part of their radii in a time (s) of free flight, as long as
/// `visit` returns true.
void IslandGroup::visitNear(double horizon, double margin, const std::function<bool(int, int)>& visit) const {
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
    if (clusters[a] != clusters[b] && areNear(boxes[a], radii[a], boxes[b], radii[b]))
      return visit(clusters[a], clusters[b]);
    return true;
  });
}

/// Whether no two islands come near each other in a time (s) of free flight.
bool IslandGroup::stayApart(double horizon) const {
  bool apart = true;
  visitNear(horizon, kApartMargin, [&](int a, int b) { return apart = islandIndexOf(a) == islandIndexOf(b); });
  return apart;
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
    settle(old);
  }
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    for (const int cluster : islands_[i].clusters) islandOfCluster_[static_cast<std::size_t>(cluster)] = i;
    twins_.connect(islands_[i].clusters);
  }
}

/// Keeps what an island has cost that is no more.
void IslandGroup::settle(const Island& island) {
  evaluations_ += island.solver->evaluations();
  work_ += island.solver->work();
}

/// The islands that had these clusters before; none at the scene's start.
std::vector<const IslandGroup::Island*> IslandGroup::formerOf(const std::vector<int>& clusters,
                                                              const std::vector<Island>& before) const {
  std::vector<const Island*> former;
  if (before.empty()) return former;
  for (const int cluster : clusters) former.push_back(&before[islandIndexOf(cluster)]);
  std::sort(former.begin(), former.end());
  former.erase(std::unique(former.begin(), former.end()), former.end());
  return former;
}

/// Pushes under way at the window's start on the bodies of some clusters.
std::vector<StartedPush> IslandGroup::startedPushes(const std::vector<int>& clusters,
                                                    const std::vector<const Island*>& former) const {
  std::vector<StartedPush> all;
  for (const Island* old : former)
    for (const StartedPush& started : old->solver->pushesAt(start_.time))
      if (std::binary_search(clusters.begin(), clusters.end(), clusters_.of(scene_.pushes[started.push].body)))
        all.push_back(started);
  return all;
}

/// The history of clusters in their former islands. A part inherits the end of a promise if it has one of the bodies
/// named there.
IslandHistory IslandGroup::historyOf(const std::vector<int>& clusters, const std::vector<const Island*>& former) const {
  const auto isAmong = [&](int cluster) { return std::binary_search(clusters.begin(), clusters.end(), cluster); };
  const auto isElsewhere = [&](int sceneBody) { return !isAmong(clusters_.of(sceneBody)); };
  IslandHistory history;
  for (const Island* old : former) {
    for (const auto& [body, count] : old->historyAtStart.bumps)
      if (isAmong(clusters_.of(body))) history.bumps[body] = count;
    const auto& end = old->historyAtStart.promiseEnd;
    if (!end || std::all_of(end->bodies.begin(), end->bodies.end(), isElsewhere)) continue;
    history.promiseEnd = history.promiseEnd ? bothOf(*history.promiseEnd, *end) : *end;
    history.hasLeftEvents = history.hasLeftEvents || old->historyAtStart.hasLeftEvents;
    history.isInContactSteps = history.isInContactSteps || old->historyAtStart.isInContactSteps;
  }
  return history;
}

IslandGroup::Island IslandGroup::makeIsland(const std::vector<int>& clusters, const std::vector<Island>& before) {
  const std::vector<const Island*> former = formerOf(clusters, before);
  return makeIsland({clusters, startedPushes(clusters, former), historyOf(clusters, former)});
}

/// An island that begins at the window's start.
IslandGroup::Island IslandGroup::makeIsland(const PartRecord& part) {
  Island island;
  island.clusters = part.clusters;
  Assembly assembly = assemblePart(scene_, clusters_.partOf(part.clusters), all_);
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
    const auto found =
        std::lower_bound(all_.joints.begin(), all_.joints.end(), joint.index,
                         [](const AssembledJoint& other, std::size_t index) { return other.index < index; });
    CRADLE_CHECK(found != all_.joints.end() && found->index == joint.index);
    island.joints.push_back(static_cast<std::size_t>(found - all_.joints.begin()));
    joints.push_back(start_.joints[island.joints.back()]);
  }
  beginAt(start_.time, state, joints, part.pushes, assembly);
  assembly.isContinued = !frames_.empty();

  island.historyAtStart = part.history;
  island.solver = std::make_unique<IslandSolver>(scene_, std::move(assembly), plan_.method, island.historyAtStart);
  island.solver->stopAt(lastStepEnd_);
  island.solver->stateAt(start_.time);
  // Other events at its first instant were told by the islands before.
  if (!frames_.empty()) island.events = island.solver->takeFirstEvents(isToldResting_);
  return island;
}

/// s: of the frames of a window, and its end.
std::vector<double> IslandGroup::timesUntil(double end) const {
  std::vector<double> times;
  for (long frame = nextFrame_; frame <= lastFrame(scene_) && frameTime(scene_, frame) <= end + sameTime(end); ++frame)
    times.push_back(frameTime(scene_, frame));
  times.push_back(end);
  return times;
}

/// Through the window that begins now, whose `times` these are. A fault may be one of a step that other bodies would
/// have ended.
void IslandGroup::move(Island& island, const std::vector<double>& times,
                       const std::function<void(double time)>& reached) const {
  island.hasMoved = true;
  try {
    if (islands_.size() > 1) island.solver->beginSweep(times.back());  // one that is alone meets nothing
    island.snapshots.reserve(times.size());
    for (const double time : times) {
      const VectorX& state = island.solver->stateAt(time, reached);
      island.snapshots.push_back({time, state, island.solver->jointStates(), {}});
      const bool isFrame = island.snapshots.size() < times.size();
      if (tellsContacts_ && isFrame) island.snapshots.back().contacts = island.solver->contactWrenches();
    }
    if (islands_.size() > kManyIslands) island.solver->releaseScratch();
  } catch (const SharedLifeSign::Over&) {  // another one tells why
  } catch (const Error& error) {
    (error.kind() == ErrorKind::interrupted ? island.failure : island.fault) = std::current_exception();
  } catch (...) {
    island.failure = std::current_exception();
  }
  const std::vector<Event> events = island.solver->takeEvents();
  island.events.insert(island.events.end(), events.begin(), events.end());
}

/// True if bodies of different islands may have met in the window: these islands are one now, at its start.
bool IslandGroup::mergeThoseThatMet() {
  if (islands_.size() == 1) return false;
  DisjointSets joined = islandsNow();
  bool isAny = joinTwins(joined);
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

/// Joins islands that are twins. True if there are any.
bool IslandGroup::joinTwins(DisjointSets& joined) {
  std::vector<Twins::Instant> events;
  for (std::size_t i = 0; i < islands_.size(); ++i)
    for (const Event& event : islands_[i].events)
      if (const int cluster = clusterOf(event); cluster >= 0 && !isOfLastingContact(event.kind))
        events.push_back({event.time, cluster, i});
  const std::vector<std::pair<int, int>> twins = twins_.find(events);
  for (const auto& [a, b] : twins) joined.join(a, b);
  return !twins.empty();
}

/// The cluster of an event's first body that has one; -1: all its bodies are driven or fixed.
int IslandGroup::clusterOf(const Event& event) const {
  const int a = clusters_.of(event.bodyA);
  return a >= 0 ? a : clusters_.of(event.bodyB);
}

/// Takes islands back to the window's start whose steps, which may go beyond its end (s), have come to a fault or to
/// the end of a promise: they go through it with a step that ends there, for other bodies may come before what they
/// met. True if there are any.
bool IslandGroup::takeBackWhatEndsBeyond(double end) {
  if (islands_.size() == 1) return false;
  bool isAny = false;
  for (Island& island : islands_) {
    if (island.stops || !endsBeyond(island, end)) continue;
    Island again = makeIsland(island.clusters, islands_);
    again.stops = true;
    again.solver->stopAt(end);
    settled_ += island.startLedger;
    settle(island);
    island = std::move(again);
    isAny = true;
  }
  return isAny;
}

bool IslandGroup::endsBeyond(const Island& island, double end) {
  if (island.fault) return true;  // perhaps
  const auto& promiseEnd = island.solver->promiseEnd();
  return !island.historyAtStart.promiseEnd && promiseEnd && promiseEnd->time > end + sameTime(end);
}

/// The motion of all islands through the window counts.
void IslandGroup::accept() {
  noteFault();
  std::vector<Snapshot> all = gather();
  if (fault_) {  // the frames that all islands have come to count
    if (frames_.empty() && all.empty()) std::rethrow_exception(fault_);
    std::move(all.begin(), all.end(), std::back_inserter(frames_));
    return takeReportsUntil(frames_.back().time);
  }
  start_ = std::move(all.back());
  all.pop_back();
  nextFrame_ += std::ssize(all);
  std::move(all.begin(), all.end(), std::back_inserter(frames_));
  evaluationsOfWindow_ = evaluations() - std::exchange(evaluationsBefore_, evaluations());
  record_.measure(start_.state);
  takeReportsUntil(start_.time);
  for (Island& island : islands_) {
    island.evaluationsOfWindow = island.solver->evaluations() - island.evaluationsBefore;
    island.evaluationsBefore = island.solver->evaluations();
    island.hasMoved = false;
    if (std::exchange(island.stops, false)) island.solver->stopAt(lastStepEnd_);
    island.historyAtStart = island.solver->history(start_.time);
  }
}

BumpCounts IslandGroup::bumpCounts() const {
  BumpCounts all;
  for (const Island& island : islands_) all.merge(island.solver->history(start_.time).bumps);
  return all;
}

/// Takes events, warnings, corrections and ends of promises of all islands up to a time (s).
void IslandGroup::takeReportsUntil(double time) {
  takeEventsUntil(time);
  for (Island& island : islands_) {
    for (std::string& warning : island.solver->takeWarnings()) warnings_.push_back(std::move(warning));
    corrections_.take(island.solver->corrections());
    const auto& end = island.solver->promiseEnd();
    if (end && end->time <= time + sameTime(time) && (!promiseEnd_ || end->time < promiseEnd_->time)) promiseEnd_ = end;
  }
}

/// The fault of the island whose clock is behind those of the others that have one.
void IslandGroup::noteFault() {
  double first = INFINITY;
  for (const Island& island : islands_) {
    if (!island.fault || island.solver->clock() >= first) continue;
    first = island.solver->clock();
    fault_ = island.fault;
  }
}

/// Tells the events of all islands up to a time (s). A driven body rests and wakes in each island that has it; its
/// first event counts.
void IslandGroup::takeEventsUntil(double time) {
  const double until = time + sameTime(time);
  std::vector<Event> all;
  for (Island& island : islands_) {
    const auto later = std::stable_partition(island.events.begin(), island.events.end(),
                                             [&](const Event& event) { return event.time <= until; });
    all.insert(all.end(), island.events.begin(), later);
    island.events.erase(island.events.begin(), later);
  }
  std::stable_sort(all.begin(), all.end(), [](const Event& a, const Event& b) { return a.time < b.time; });
  for (const Event& event : all) {
    if (event.kind == EventKind::rest || event.kind == EventKind::wake) {
      char& isResting = isToldResting_[static_cast<std::size_t>(event.bodyA)];
      if ((isResting != 0) == (event.kind == EventKind::rest)) continue;
      isResting = event.kind == EventKind::rest;
    }
    events_.push_back(event);
  }
}

/// All bodies at the islands' snapshots, which are taken away; if an island has come to a fault, at those that all
/// have.
std::vector<IslandGroup::Snapshot> IslandGroup::gather() {
  std::size_t count = islands_.front().snapshots.size();
  for (const Island& island : islands_) count = std::min(count, island.snapshots.size());
  std::vector<Snapshot> all(count, start_);
  for (Snapshot& whole : all) whole.state.tail<kLedgerSize>() = settled_, whole.contacts.clear();
  for (Island& island : islands_) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Snapshot& part = island.snapshots[i];
      all[i].time = part.time;
      place(island, part.state, all[i].state);
      all[i].state.tail<kLedgerSize>() += part.state.tail<kLedgerSize>();
      for (std::size_t joint = 0; joint < island.joints.size(); ++joint)
        all[i].joints[island.joints[joint]] = part.joints[joint];
      all[i].contacts.insert(all[i].contacts.end(), part.contacts.begin(), part.contacts.end());
    }
    if (!island.snapshots.empty()) island.startLedger = island.snapshots.back().state.tail<kLedgerSize>();
    island.snapshots = {};
  }
  return all;
}

}  // namespace cradle
