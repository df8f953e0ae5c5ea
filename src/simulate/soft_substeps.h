#pragma once

#include <optional>
#include <vector>

#include "impact/soft_step.h"
#include "simulate/assembly.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// An island of many bodies that gravity and contact move, in motion: by soft sub-stepping.
class SoftSubsteps {
 public:
  /// Steps end at the times asked for, and are no longer than `longestStep` (s). Without `threads`, large heaps take as
  /// many as the machine has; the result is the same for any number.
  SoftSubsteps(Assembly assembly, double longestStep, std::optional<int> threads = std::nullopt);
  SoftSubsteps(const SoftSubsteps&) = delete;
  SoftSubsteps& operator=(const SoftSubsteps&) = delete;

  /// The state at `time` (s), not earlier than in the call before. Throws Error(unstable) if the state is not
  /// finite, or there is more energy than at the start.
  const VectorX& stateAt(double time);

  const Assembly& assembly() const { return assembly_; }

  /// Detection passes: calls of collision detection.
  long evaluations() const { return step_.detections(); }

  /// Events since the last call: impacts, rest and waking, at the ends of steps.
  std::vector<Event> takeEvents();

 private:
  void takeStep(double timeStep);
  void book(double constant);
  void requireNoGain() const;
  void record();

  Assembly assembly_;
  VectorX state_;
  double longestStep_;
  SoftStep step_;
  double startEnergy_ = 0;  // J
  double time_ = 0;         // s
  std::vector<Event> events_;
};

}  // namespace cradle
