#pragma once

#include <functional>
#include <vector>

#include "collision/time_of_impact.h"
#include "simulate/assembly.h"
#include "simulate/contact_stage.h"
#include "simulate/energy_guard.h"
#include "simulate/push_schedule.h"
#include "simulate/rope_stage.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// The fixed-step method that a scene names, or the one that stands in for a plan.
struct ChosenMethod {
  Integrator integrate;
  const char* name;
  double timeStep;        // s
  double stabilityLimit;  // of step x omega
};
ChosenMethod chooseMethod(const Scene& scene);

/// A scene in motion. Time goes on in steps of the method; a step is cut where bodies meet, ropes go
/// taut or slack, and pushes begin or end.
class Simulation {
 public:
  /// Keeps a reference to `scene`.
  Simulation(const Scene& scene, Assembly assembly);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Goes on to the end of the step, or to the next event in it, and resolves what happens there. Throws
  /// Error(unstable) if the state blows up, Error(limit) if a step has too many impacts.
  void advance();

  double time() const { return time_; }
  const VectorX& state() const { return state_; }
  /// The state at a time inside the motion that led to time(), before contacts were resolved there.
  VectorX stateWithin(double time);
  long evaluations() const { return equations_.evaluations(); }
  EnergyBalance energyOf(const VectorX& state) const;

  /// Events since the last call.
  std::vector<Event> takeEvents() { return log_.take(); }
  /// What the user should know, since the last call.
  std::vector<std::string> takeWarnings() { return log_.takeWarnings(); }

 private:
  void integrate(double stepEnd);
  bool stopAtFirstEvent();
  void shortenStepTo(double length, double tolerance, const std::function<double(const VectorX&)>& margin);
  void beginAndEndPushes();
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
  double duration_;      // s
  double time_ = 0;      // s
  long stepNumber_ = 0;  // the step under way covers [stepNumber_, stepNumber_ + 1] x timeStep
  int eventsInStep_ = 0;
  VectorX state_;
  Step step_;
};

}  // namespace cradle
