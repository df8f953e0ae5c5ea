#pragma once

#include <cmath>
#include <deque>
#include <memory>
#include <vector>

#include "simulate/contact_wrenches.h"
#include "simulate/energy_guard.h"
#include "simulate/island_state.h"
#include "simulate/limit_events.h"
#include "simulate/steps/step_contacts.h"

namespace cradle {

/// Moves an island in steps of one length, for methods that a scene names and for contact that is too much for events.
/// A step is cut at impacts, where ropes go taut or slack, and where pushes begin or end; contacts that last are solved
/// over it.
class SteppedMotion {
 public:
  /// Keeps references to the island, which it moves, and its ropes. The method has a fixed step; the first begins now.
  SteppedMotion(IslandState& island, LimitEvents& ropes, const ChosenMethod& method);

  /// Takes a step, or goes to an event inside it. `frame` (s) is the next time whose state is asked for. Throws
  /// Error(unstable) if the state blows up, Error(limit) if a step has too many impacts.
  void advance(double frame);

  /// Whether the last step kept the bodies' constraints: its interpolant may be projected.
  bool keepsConstraints() const { return keepsConstraints_; }

  /// Adds to a state inside the last step's free motion, at a fraction of it, what contacts changed: velocities in
  /// proportion to the fraction, positions to its square.
  void addContactMotion(double fraction, VectorX& state) const;

  /// Forces (N or N m) of the motors in the last step, the mean of those that hold against contacts.
  const VectorX& motorForces() const { return motorForces_; }

  /// Adds the mean forces of contacts over StepContacts::kContactTime up to `time` (s), or since these steps began; of
  /// bodies that rest those that keep them still. Impacts that were told as events are left out.
  void addMeanLoads(double time, WrenchSum& sum) const;

  /// Whether all bodies of the island lie still.
  bool isAtRest() const;

  /// Whether nothing touches any more.
  bool isFree() const { return contacts_.touching().empty(); }

  /// Whether events could serve the contacts of the last step.
  bool mayServeEvents() const;

  /// Lets time pass in which nothing moves.
  void restUntil(double time);

 private:
  void requireRoom() const;
  void countSteps();
  double nextStepEnd() const;
  void moveFreely(double stepEnd);
  double longestBesideSheets() const;
  bool stopAtFirstEvent();
  bool stopAtNextImpact();
  bool solveContacts();
  void holdReachedTargets();
  void pushWithAllForce();
  bool exhaustMotors();
  void shorten();
  void countEvent();

  IslandState& island_;
  LimitEvents& ropes_;
  ChosenMethod method_;
  StepContacts contacts_;
  EnergyGuard guard_;
  ConstraintSolver solver_;
  long stepNumber_ = 0;           // the step under way covers [stepNumber_, stepNumber_ + 1] x timeStep
  double longest_ = INFINITY;     // s: four times the length that the error allowed last
  bool keepsConstraints_ = true;  // no rope went taut or slack at the last step's end
  int eventsInWindow_ = 0;
  double windowStart_ = 0;           // s
  double startConstraintError_ = 0;  // m or rad
  VectorX before_;
  std::vector<int> tautRowsBefore_;  // of ropes, before the changes of a step
  bool hasContacts_ = false;         // contacts were solved over the last step ...
  VectorX contactEnd_;               // ... and led to this state
  VectorX motorForces_;
  std::vector<double> innerRadii_;  // m, of the colliders
  using Supports = std::shared_ptr<const std::vector<SupportForce>>;
  struct StepLoads {
    double begin, end;               // s
    std::vector<ContactLoad> loads;  // impulses
    Supports supports;               // of bodies at rest in the step
  };
  void keepLoads(double begin);
  Supports supportsOfStep_;
  std::deque<StepLoads> loads_;  // of the last steps that had any, by kContactTime
  double begin_;                 // s, of the first step
};

}  // namespace cradle
