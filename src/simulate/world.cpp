#include "simulate/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <numeric>
#include <utility>

#include "constraints/invariants.h"
#include "core/error.h"
#include "core/interruption.h"
#include "simulate/life_sign.h"
#include "simulate/shared_islands.h"
#include "simulate/start_overlaps.h"
#include "simulate/thresholds.h"

namespace cradle {
namespace {

void add(const Invariants& sums, const VectorX& state, EnergyBalance& balance) {
  balance.kinetic += sums.kinetic;
  balance.potential += sums.potential;
  balance.dissipated += dissipatedEnergy(state);
  balance.impact += impactEnergy(state);
  balance.friction += frictionEnergy(state);
  balance.damping += dampingEnergy(state);
  balance.numerical += numericalEnergy(state);
  balance.work += pushWork(state);
  balance.momentum += sums.momentum;
  balance.angularMomentum += sums.angularMomentum;
}

}  // namespace

World::World(const Scene& scene)
    : scene_(scene), plan_(planOf(scene)), joints_(scene.hinges.size() + scene.sliders.size()) {
  for (const Body& body : scene.bodies) {
    if (body.prescribed) cradle::add(static_cast<int>(moving_), *body.prescribed, driven_);
    stateOfBody_.push_back(body.motion == Motion::fixed ? -1 : static_cast<int>(moving_++));
  }
  std::vector<Assembly> assemblies;
  for (const IslandPlan& island : plan_.islands) assemblies.push_back(assemble(scene, island));
  correctStartPenetrations(scene, assemblies);
  for (std::size_t i = 0; i < assemblies.size(); ++i) {
    startWarnings_.insert(startWarnings_.end(), assemblies[i].warnings.begin(), assemblies[i].warnings.end());
    hasLongSteps_ = hasLongSteps_ || assemblies[i].hasLongSteps;
    if (scene.bumps && plan_.islands[i].method.kind == MotionKind::pile)
      startWarnings_.push_back(
          fmt::format("{}: impacts of {} have no bumps: many bodies may touch, and soft contacts "
                      "decide; ask for an accuracy of {} or finer to have them",
                      scene.path, namesOfBodies(plan_.islands[i].bodies, scene), kVisualAccuracy));
    move(i, std::move(assemblies[i]));
  }
  decideStartPromises();
}

void World::decideStartPromises() {
  promiseEnds_.resize(plan_.islands.size());
  notePromiseEnds();
  for (std::size_t i = 0; i < promiseEnds_.size(); ++i) {
    if (!promiseEnds_[i]) continue;
    const std::string names = namesOfBodies(promiseEnds_[i]->bodies, scene_);
    plan_.islands[i].promise = {
        Promise::Kind::none, {}, fmt::format("{} ({}) at the start", promiseEnds_[i]->reason, names)};
  }
}

void World::notePromiseEnds() {
  forEachSolver([this](const auto& solver, std::size_t island) {
    std::optional<PromiseEnd>& known = promiseEnds_[island];
    if (known || !solver.promiseEnd()) return;
    known = solver.promiseEnd();
    newEnds_.push_back(*known);
    warnings_.push_back(known->warning);
  });
}

/// Calls visit(solver, island) with the index of its island in the plan.
template <class Visit>
void World::forEachSolver(const Visit& visit) const {
  for (std::size_t i = 0; i < solvers_.size(); ++i) visit(*solvers_[i], islandOfSolver_[i]);
  for (std::size_t i = 0; i < groups_.size(); ++i) visit(*groups_[i], islandOfGroup_[i]);
}

std::vector<PromiseEnd> World::takePromiseEnds() {
  std::vector<PromiseEnd> ends = std::exchange(newEnds_, {});
  std::stable_sort(ends.begin(), ends.end(), [](const PromiseEnd& a, const PromiseEnd& b) { return a.time < b.time; });
  return ends;
}

void World::move(std::size_t index, Assembly assembly) {
  const IslandPlan& island = plan_.islands[index];
  switch (island.method.kind) {
    case MotionKind::freeFlight:
      return addFlight(std::move(assembly));
    case MotionKind::elasticFlight:
      spheres_.push_back(std::make_unique<HardSpheres>(scene_, std::move(assembly), *hardSpheresOf(scene_, island)));
      islandOfSpheres_.push_back(index);
      return;
    case MotionKind::pile:
      softIslands_.push_back(std::make_unique<SoftSubsteps>(std::move(assembly), island.method.timeStep));
      islandOfSoftIsland_.push_back(index);
      return;
    case MotionKind::fixedSteps:
    case MotionKind::errorSteps:
      if (IslandGroup::mayDivide(scene_, island)) {
        groups_.push_back(std::make_unique<IslandGroup>(scene_, island, std::move(assembly), threads_));
        islandOfGroup_.push_back(index);
        return;
      }
      solvers_.push_back(std::make_unique<IslandSolver>(scene_, std::move(assembly), island.method));
      islandOfSolver_.push_back(index);
  }
}

void World::addFlight(Assembly assembly) {
  FlyingIsland island{std::move(assembly), {}};
  const Mechanism& mechanism = island.assembly.mechanism;
  for (std::size_t body = 0; body < mechanism.bodies.size(); ++body)
    island.flights.emplace_back(mechanism.bodies[body], island.assembly.state, static_cast<Eigen::Index>(body),
                                mechanism.gravity);
  flying_.push_back(std::move(island));
}

Frame World::frameAt(long number, double time, const std::function<void(double time)>& reached) {
  throwIfInterrupted();
  Frame frame{number, time, std::vector<BodyState>(moving_), {}, std::vector<JointState>(joints_)};
  const std::vector<const VectorX*> states = moveTo(time, reached);
  std::size_t moved = 0;
  forEachSolver([&](auto& simulation, std::size_t) {
    takeFrom(simulation, *states[moved++], frame);
    for (std::size_t i = 0; i < simulation.jointStates().size(); ++i)
      frame.joints[simulation.assembly().joints[i].index] = simulation.jointStates()[i];
  });
  lastTime_ = time, lastFrame_ = number;
  notePromiseEnds();
  for (const auto& spheres : spheres_) takeFrom(*spheres, spheres->stateAt(time), frame);
  for (const auto& pile : softIslands_) takeFrom(*pile, pile->stateAt(time), frame);
  for (FlyingIsland& island : flying_) {
    for (const FreeFlight& flight : island.flights) flight.moveTo(time, island.assembly.state);
    island.evaluations += std::ssize(island.flights);
    addTo(frame, island.assembly, island.assembly.state);
  }
  for (const DrivenBody& driven : driven_) {  // of islands or not
    const PoseMotion now = motionAt(driven.motion, time);
    frame.states[static_cast<std::size_t>(driven.body)] = {now.pose.translation, now.pose.rotation, now.velocity,
                                                           now.angularVelocity};
  }
  return frame;
}

/// Moves islands that have solvers, then groups, to the time of a frame; returns their states.
std::vector<const VectorX*> World::moveTo(double time, const std::function<void(double time)>& reached) {
  std::vector<const VectorX*> states(solvers_.size() + groups_.size());
  std::atomic<std::size_t> done = 0;
  std::function<void(double)> tellMean;
  if (reached)
    tellMean = [&](double now) {
      const double ofDone = static_cast<double>(done.load()) * (time - lastTime_);
      reached(lastTime_ + (ofDone + std::min(now, time) - lastTime_) / static_cast<double>(states.size()));
    };
  const SharedLifeSign signs(tellMean);
  std::vector<std::exception_ptr> failures(solvers_.size());
  const auto evaluationsSoFar = [this] {
    return std::accumulate(solvers_.begin(), solvers_.end(), 0L,
                           [](long sum, const auto& solver) { return sum + solver->evaluations(); });
  };
  const long before = evaluationsSoFar();
  shareIslands(threads_, solvers_.size(), evaluationsOfFrame_, [&](int thread, std::size_t i) {
    try {
      states[i] = &solvers_[i]->stateAt(time, signs.ofThread(thread));
    } catch (const SharedLifeSign::Over&) {  // another one tells why
    } catch (...) {
      failures[i] = std::current_exception();
    }
    ++done;
  });
  evaluationsOfFrame_ = evaluationsSoFar() - before;
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  for (std::size_t i = 0; i < groups_.size(); ++i, ++done)
    states[solvers_.size() + i] = &groups_[i]->stateAt(time, tellMean);
  return states;
}

/// Adds the states and events of an island at the time of a frame.
template <class Simulation>
void World::takeFrom(Simulation& simulation, const VectorX& state, Frame& frame) {
  addTo(frame, simulation.assembly(), state);
  const std::vector<Event> events = simulation.takeEvents();
  events_.insert(events_.end(), events.begin(), events.end());
}

void World::tellContacts() {
  tellsContacts_ = true;
  for (const auto& group : groups_) group->tellContacts();
}

std::vector<ContactWrench> World::contactWrenches() {
  std::vector<ContactWrench> all;
  const auto add = [&all](const std::vector<ContactWrench>& wrenches) {
    all.insert(all.end(), wrenches.begin(), wrenches.end());
  };
  forEachSolver([&add](auto& solver, std::size_t) { add(solver.contactWrenches()); });
  for (const auto& spheres : spheres_) add(spheres->contactWrenches());
  for (const auto& pile : softIslands_) add(pile->contactWrenches());
  std::stable_sort(all.begin(), all.end(), [](const ContactWrench& a, const ContactWrench& b) {
    return std::pair(a.bodyA, a.bodyB) < std::pair(b.bodyA, b.bodyB);
  });
  return all;
}

void World::finish() {
  forEachSolver([](auto& solver, std::size_t) { solver.finish(); });
  notePromiseEnds();
}

void World::addTo(Frame& frame, const Assembly& assembly, const VectorX& state) const {
  for (std::size_t i = 0; i < assembly.sceneBodies.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const int at = stateOfBody_[static_cast<std::size_t>(assembly.sceneBodies[i])];
    frame.states[static_cast<std::size_t>(at)] = {centerOfMass(state, body), orientation(state, body),
                                                  linearVelocity(state, body), angularVelocity(state, body)};
  }
  add(invariantsOf(assembly.mechanism, state), state, frame.energy);
}

std::vector<Event> World::takeEvents(double time) {
  const double until = time + sameTime(time);
  std::stable_sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) { return a.time < b.time; });
  const auto later =
      std::find_if(events_.begin(), events_.end(), [&](const Event& event) { return event.time > until; });
  const std::vector<Event> taken(events_.begin(), later);
  events_.erase(events_.begin(), later);
  return taken;
}

std::vector<std::string> World::takeWarnings() {
  std::vector<std::string> warnings = std::exchange(warnings_, {});
  forEachSolver([&](auto& solver, std::size_t) {
    for (std::string& warning : solver.takeWarnings()) warnings.push_back(std::move(warning));
  });
  return warnings;
}

std::vector<Correction> World::takeCorrections() {
  std::vector<Correction> all, first;
  forEachSolver([&](auto& solver, std::size_t) {
    for (Correction& correction : solver.corrections().takeFirst()) all.push_back(std::move(correction));
  });
  std::stable_sort(all.begin(), all.end(), [](const Correction& a, const Correction& b) { return a.time < b.time; });
  for (Correction& correction : all)
    if (!std::exchange(isToldOf_[static_cast<std::size_t>(correction.kind)], 1)) first.push_back(std::move(correction));
  return first;
}

std::map<std::string, long> World::correctionCounts() const {
  std::map<std::string, long> counts;
  for (std::size_t kind = 0; kind < kCorrectionKinds; ++kind)
    if (before_.corrections[kind] > 0)
      counts[correctionName(static_cast<CorrectionKind>(kind))] = before_.corrections[kind];
  forEachSolver([&](auto& solver, std::size_t) { solver.corrections().addCounts(counts); });
  return counts;
}

BumpCounts World::bumpCounts() const {
  BumpCounts all;
  forEachSolver([&](const auto& solver, std::size_t) { all.merge(solver.bumpCounts()); });
  return all;
}

double World::clock() const {
  double latest = lastTime_;
  forEachSolver([&](const auto& solver, std::size_t) { latest = std::max(latest, solver.clock()); });
  return latest;
}

void World::stopAt(double time) {
  forEachSolver([time](auto& solver, std::size_t) { solver.stopAt(time); });
}

WorldRecord World::record() const {
  CRADLE_CHECK(events_.empty() && warnings_.empty() && newEnds_.empty());
  WorldRecord record;
  record.time = lastTime_, record.frame = lastFrame_;
  for (const auto& solver : solvers_) record.islands.push_back(solver->record());
  for (const auto& group : groups_) record.groups.push_back(group->record());
  for (const auto& spheres : spheres_) record.spheres.push_back(spheres->record());
  for (const auto& pile : softIslands_) record.softIslands.push_back(pile->record());
  record.promiseEnds = promiseEnds_, record.isToldOf = isToldOf_;
  record.corrections = before_.corrections;
  forEachSolver([&](auto& solver, std::size_t) {
    for (std::size_t kind = 0; kind < kCorrectionKinds; ++kind)
      record.corrections[kind] += solver.corrections().counts()[kind];
  });
  record.evaluations = evaluations();
  return record;
}

void World::goOnFrom(const WorldRecord& record) {
  before_ = {record.corrections, record.evaluations};
  lastTime_ = record.time, lastFrame_ = record.frame;
  promiseEnds_ = record.promiseEnds, isToldOf_ = record.isToldOf;
  events_.clear(), warnings_.clear(), newEnds_.clear();
  for (FlyingIsland& island : flying_) island.evaluations = 0;
  for (std::size_t i = 0; i < solvers_.size(); ++i) {
    const IslandPlan& island = plan_.islands[islandOfSolver_[i]];
    const IslandRecord& from = record.islands.at(i);
    Assembly assembly = assemble(scene_, island);
    beginAt(record.time, from.state, from.joints, from.parts.front().pushes, assembly);
    assembly.isContinued = true;
    solvers_[i] = std::make_unique<IslandSolver>(scene_, std::move(assembly), island.method, from);
    solvers_[i]->stateAt(record.time);
    std::vector<char> isToldResting(scene_.bodies.size(), 0);
    addResting(from.parts.front(), solvers_[i]->assembly().sceneBodies, isToldResting);
    const std::vector<Event> first = solvers_[i]->takeFirstEvents(isToldResting);
    events_.insert(events_.end(), first.begin(), first.end());
  }
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const IslandPlan& island = plan_.islands[islandOfGroup_[i]];
    groups_[i] = std::make_unique<IslandGroup>(scene_, island, assemble(scene_, island), threads_, record.groups.at(i),
                                               record.frame, record.time);
    if (tellsContacts_) groups_[i]->tellContacts();
  }
  for (std::size_t i = 0; i < spheres_.size(); ++i) {
    const IslandPlan& island = plan_.islands[islandOfSpheres_[i]];
    spheres_[i] = std::make_unique<HardSpheres>(scene_, assemble(scene_, island), *sphereWorldOf(scene_, island),
                                                record.spheres.at(i));
  }
  for (std::size_t i = 0; i < softIslands_.size(); ++i) {
    const IslandPlan& island = plan_.islands[islandOfSoftIsland_[i]];
    softIslands_[i] =
        std::make_unique<SoftSubsteps>(assemble(scene_, island), island.method.timeStep, record.softIslands.at(i));
  }
}

long World::work() const {
  long sum = 0;
  for (const auto& solver : solvers_) sum += solver->work();
  for (const auto& group : groups_) sum += group->work();
  for (const auto& spheres : spheres_) sum += spheres->work();
  for (const auto& pile : softIslands_) sum += pile->work();
  return sum;
}

long World::evaluations() const {
  long sum = before_.evaluations;
  forEachSolver([&](const auto& solver, std::size_t) { sum += solver.evaluations(); });
  for (const auto& spheres : spheres_) sum += spheres->evaluations();
  for (const auto& pile : softIslands_) sum += pile->evaluations();
  for (const FlyingIsland& island : flying_) sum += island.evaluations;
  return sum;
}

}  // namespace cradle
