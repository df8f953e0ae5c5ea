#pragma once

#include <functional>
#include <vector>

#include "collision/broad_phase.h"
#include "collision/time_of_impact.h"
#include "dynamics/integrators/step_size.h"
#include "simulate/assembly.h"
#include "simulate/contact_stage.h"
#include "simulate/energy_guard.h"
#include "simulate/push_schedule.h"
#include "simulate/rope_stage.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// An island in motion, with a clock of its own. Time goes on in steps of the method; a step is cut where bodies meet,
/// ropes go taut or slack, and pushes begin or end.
class Simulation {
 public:
  /// Keeps a reference to `scene`. The method is one that takes steps.
  Simulation(const Scene& scene, Assembly assembly, const ChosenMethod& method);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// The state at `time` (s), not earlier than in the call before; orientations of unit length. At an instant of events
  /// the state after them. Throws Error(unstable) if the state blows up, Error(limit) if a step has too many impacts,
  /// Error(interrupted).
  const VectorX& stateAt(double time);

  const Assembly& assembly() const { return assembly_; }
  long evaluations() const { return equations_.evaluations(); }

  /// Events since the last call: up to the end of the step under way.
  std::vector<Event> takeEvents() { return log_.take(); }
  std::vector<std::string> takeWarnings() { return log_.takeWarnings(); }

 private:
  void advance(double frame);
  double nextStepEnd() const;
  void takeStep(double stepEnd);
  void takeAdaptiveStep(double stepEnd);
  void integrate(double stepEnd);
  void findNearPairs();
  bool stopAtFirstEvent();
  void shortenStepTo(double length, double tolerance, const std::function<double(const VectorX&)>& margin);
  void beginAndEndPushes();
  void tidyState();
  void requireTiesKept() const;
  void spin(Eigen::Index body, double time, VectorX& state) const;
  bool isAtRest() const;
  void restUntil(double time);
  void countEvent();
  void requireUnsolvedPairsApart() const;

  const Scene& scene_;
  Assembly assembly_;
  ChosenMethod method_;
  EquationsOfMotion equations_;
  RightHandSide rightHandSide_;
  EventLog log_;
  ContactStage contacts_;
  RopeStage ropes_;
  PushSchedule pushes_;
  EnergyGuard guard_;
  ConstraintSolver solver_;
  BroadPhase broadPhase_;
  std::vector<double> motions_;  // m: how far the points of each body may go within the step under way
  VectorX tolerance_;            // of an adaptive method
  double startTieError_ = 0;     // m or rad
  StepSize stepSize_;
  int shortSteps_ = 0;         // in a row
  bool isContinuous_ = false;  // nothing has changed the state since the last step's end
  bool keepsTies_ = true;      // no rope went taut or slack at the last step's end
  double time_ = 0;            // s
  long stepNumber_ = 0;        // of a fixed step: the one under way covers [stepNumber_, stepNumber_ + 1] x timeStep
  int eventsInWindow_ = 0;
  double windowStart_ = 0;  // s
  VectorX state_, before_, reported_;
  Step step_;
};

}  // namespace cradle
