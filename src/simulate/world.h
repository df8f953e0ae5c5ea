#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dynamics/free_flight.h"
#include "simulate/island_group.h"
#include "simulate/soft_substeps.h"
#include "simulate/spheres/hard_spheres.h"
#include "simulate/world_record.h"

namespace cradle {

/// The world: all islands of a scene in motion, each with a solver and a clock of its own.
class World {
 public:
  /// Keeps a reference to `scene`. Throws Error(scene) for bodies that overlap.
  explicit World(const Scene& scene);

  /// How the scene is simulated; what the first instant decides of its promises is in it.
  const Plan& plan() const { return plan_; }

  /// Of each island of the plan, when events gave it up; none while they serve, or if they never were to.
  const std::vector<std::optional<PromiseEnd>>& promiseEnds() const { return promiseEnds_; }

  /// Those since the last call, in the order of time.
  std::vector<PromiseEnd> takePromiseEnds();

  /// Warnings about the start.
  const std::vector<std::string>& startWarnings() const { return startWarnings_; }

  /// Whether these tell that the scene's steps are too long for a spring.
  bool hasLongSteps() const { return hasLongSteps_; }

  /// The frame at a time (s) not earlier than in the call before. Throws what IslandSolver::stateAt throws. `reached`
  /// is told the mean of the islands' clocks (s) after each of their steps; it may be none.
  Frame frameAt(long number, double time, const std::function<void(double time)>& reached = {});

  /// To be called before the first frame if contactWrenches is to be.
  void tellContacts();

  /// What lasting contacts do in the last frame, ascending by bodies.
  std::vector<ContactWrench> contactWrenches();

  /// To be called after the last frame: ends promises that the frames as a whole did not keep.
  void finish();

  /// Events up to `time` that were not taken before, in the order of time.
  std::vector<Event> takeEvents(double time);

  /// Warnings since the last call.
  std::vector<std::string> takeWarnings();

  /// Corrections since the last call that were the first of their kind in the run, in the order of time.
  std::vector<Correction> takeCorrections();

  /// How often each kind of correction has happened so far.
  std::map<std::string, long> correctionCounts() const;

  /// s: the latest clock of an island.
  double clock() const;

  /// No step goes beyond `time` (s), not before clock().
  void stopAt(double time);

  /// To go on from, at a frame at which all steps end; all that there is to be taken was.
  WorldRecord record() const;

  /// Throws all motion away and builds it again from a record.
  void goOnFrom(const WorldRecord& record);

  /// As IslandSolver's, of all, since the start or the record gone on from: a measure of time that is the same in each
  /// run.
  long work() const;

  /// Impacts with bumps of each scene body so far; none for those that have had none.
  BumpCounts bumpCounts() const;

  /// Evaluations of equations of motion, and of closed forms, so far.
  long evaluations() const;

 private:
  /// Bodies that nothing but gravity acts upon.
  struct FlyingIsland {
    Assembly assembly;
    std::vector<FreeFlight> flights;
    long evaluations = 0;
  };
  void move(std::size_t island, Assembly assembly);
  void decideStartPromises();
  void notePromiseEnds();
  void addFlight(Assembly assembly);
  std::vector<const VectorX*> moveTo(double time, const std::function<void(double time)>& reached);
  template <class Simulation>
  void takeFrom(Simulation& simulation, const VectorX& state, Frame& frame);
  void addTo(Frame& frame, const Assembly& assembly, const VectorX& state) const;

  const Scene& scene_;
  Plan plan_;
  std::vector<std::string> startWarnings_;
  bool hasLongSteps_ = false;
  template <class Visit>
  void forEachSolver(const Visit& visit) const;

  WorkerThreads threads_{hardwareThreads()};
  std::vector<std::unique_ptr<IslandSolver>> solvers_;
  long evaluationsOfFrame_ = 0;  // of solvers, in the last one
  std::vector<std::unique_ptr<IslandGroup>> groups_;
  std::vector<std::size_t> islandOfSolver_, islandOfGroup_, islandOfSpheres_, islandOfSoftIsland_;  // of the plan
  std::vector<std::optional<PromiseEnd>> promiseEnds_;                                              // by island
  std::vector<PromiseEnd> newEnds_;                                                                 // not yet taken
  std::vector<std::string> warnings_;                                                               // not yet taken
  std::vector<FlyingIsland> flying_;
  std::vector<std::unique_ptr<HardSpheres>> spheres_;
  std::vector<std::unique_ptr<SoftSubsteps>> softIslands_;
  std::vector<int> stateOfBody_;                      // of each scene body in a frame's states, or -1
  std::size_t moving_ = 0, joints_ = 0;               // states of a frame
  std::vector<DrivenBody> driven_;                    // by their places in a frame's states
  std::array<char, kCorrectionKinds> isToldOf_ = {};  // kinds of corrections
  std::vector<Event> events_;                         // known, but not yet taken
  double lastTime_ = 0;                               // s, of the latest frame
  long lastFrame_ = 0;
  bool tellsContacts_ = false;
  struct Counts {
    std::array<long, kCorrectionKinds> corrections = {};
    long evaluations = 0;
  };
  Counts before_;  // the record that it has gone on from
};

}  // namespace cradle
