#pragma once

#include <vector>

#include "collision/time_of_impact.h"
#include "simulate/assembly.h"
#include "simulate/energy_guard.h"
#include "simulate/resting_bodies.h"
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

/// A scene in motion. Time goes on in steps of the method; a step is cut where bodies meet.
class Simulation {
 public:
  Simulation(const Scene& scene, Assembly assembly);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Goes on to the end of the step, or to the next impact in it, and resolves what happens there. Throws
  /// Error(unstable) if the state blows up, Error(limit) if a step has too many impacts.
  void advance();

  double time() const { return time_; }
  const VectorX& state() const { return state_; }
  /// The state at a time inside the motion that led to time(), before contacts were resolved there.
  VectorX stateWithin(double time);
  long evaluations() const { return equations_.evaluations(); }
  EnergyBalance energyOf(const VectorX& state) const;

  /// Events since the last call.
  std::vector<Event> takeEvents();

 private:
  void integrate(double stepEnd);
  bool stopAtFirstImpact();
  void shortenStepTo(const ImpactTime& impact);
  void resolveContacts(const VectorX& before);
  void findTouching();
  void wakeTouched();
  bool resolveImpacts();
  void holdLasting(const VectorX& before);
  double restSpeed(const Contact& contact, const VectorX& rate) const;
  void record(EventKind kind, int movingBody);
  void record(const Contact& contact, double impulse);

  Assembly assembly_;
  ChosenMethod method_;
  EquationsOfMotion equations_;
  RightHandSide rightHandSide_;
  RestingBodies resting_;
  EnergyGuard guard_;
  ConstraintSolver solver_;
  double touchTolerance_;  // m
  double duration_;        // s
  double time_ = 0;        // s
  long stepNumber_ = 0;    // the step under way covers [stepNumber_, stepNumber_ + 1] x timeStep
  int impactsInStep_ = 0;
  VectorX state_, rate_;
  Step step_;
  std::vector<Contact> touching_;
  std::vector<Event> events_;
};

}  // namespace cradle
