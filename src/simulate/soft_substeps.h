#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "impact/soft_step.h"
#include "simulate/assembly.h"
#include "simulate/contact_wrenches.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// An island of many bodies that gravity, contact and driven bodies move, in motion: by soft sub-stepping.
class SoftSubsteps {
 public:
  /// Steps end at the times asked for, and are no longer than `longestStep` (s), of small bodies by their SoftScale.
  /// Without `threads`, large heaps take as many as the machine has; the result is the same for any number.
  SoftSubsteps(Assembly assembly, double longestStep, std::optional<int> threads = std::nullopt);

  /// All that a run needs beside the assembly to go on.
  struct Record {
    double time = 0;  // s
    VectorX state;
    SoftStep::Record step;
    double startEnergy = 0;  // J
    bool hasSleepChanged = false;
    std::map<std::pair<int, int>, ContactWrench> atRest;  // by scene bodies
  };
  /// Goes on from a record.
  SoftSubsteps(Assembly assembly, double longestStep, const Record& record);
  SoftSubsteps(const SoftSubsteps&) = delete;
  SoftSubsteps& operator=(const SoftSubsteps&) = delete;

  /// The state at `time` (s), not earlier than in the call before. Throws Error(unstable) if the state is not finite,
  /// there is more energy than at the start and by the work of driven bodies, or these leave others no room.
  const VectorX& stateAt(double time);

  /// What contacts did in the mean of the last sub-steps between two looks for contacts, but those of bodies that met
  /// in the last step: that is an event. Between bodies asleep what holds them still.
  std::vector<ContactWrench> contactWrenches();

  const Assembly& assembly() const { return assembly_; }

  Record record() const { return {time_, state_, step_.record(), startEnergy_, hasSleepChanged_, atRest_}; }

  /// As IslandSolver's. A step and a record cost in proportion to the bodies: a record is due after so many steps,
  /// however many bodies there are.
  long work() const { return kWorkOfDetection * step_.detections(); }

  /// Detection passes: calls of collision detection.
  long evaluations() const { return step_.detections(); }

  /// Events since the last call: impacts, rest and waking, at the ends of steps.
  std::vector<Event> takeEvents();

 private:
  static constexpr long kWorkOfDetection = 1500;  // 2000 looks for contacts between checkpoints (kCheckpointWork)
  void takeStep(double timeStep);
  bool isAwake(int sceneBody) const;
  bool isStill(const ColliderPair& pair) const;
  void findLoadsAtRest();
  void addLoad(const SoftContacts::Meeting& contact, const std::vector<SoftContactSolver::MeanLoad>& loads,
               WrenchSum& sum) const;
  void lead(double timeStep);
  void place();
  void requireRoom() const;
  void book(double constant);
  void requireNoGain() const;
  void addEvents();

  Assembly assembly_;
  VectorX state_;
  std::vector<RigidBody> bodies_;  // those of the mechanism, driven ones as heavy bodies
  SoftStep step_;
  double longestStep_;              // s
  std::vector<double> innerRadii_;  // m, of the bodies; infinite without a collider
  VectorX led_;                     // state in which the step under way began
  double startEnergy_ = 0;          // J
  double time_ = 0;                 // s
  std::vector<Event> events_;
  bool hasSleepChanged_ = false;                         // since loads at rest were found
  std::map<std::pair<int, int>, ContactWrench> atRest_;  // by scene bodies
};

}  // namespace cradle
