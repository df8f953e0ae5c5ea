#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "dynamics/integrators/step_size.h"
#include "math/running_integral.h"
#include "simulate/energy_guard.h"
#include "simulate/events/event_contacts.h"
#include "simulate/events/event_location.h"
#include "simulate/events/event_tolerances.h"
#include "simulate/island_state.h"
#include "simulate/limit_events.h"
#include "simulate/motor_events.h"
#include "simulate/plan/event_rate_limit.h"

namespace cradle {

/// Moves an island in steps as long as the accuracy allows. Each step ends at the first event in it: a gap closes, an
/// active contact changes, a rope goes taut or slack, a push begins or ends. Between events the motion is of order 8,
/// or 5 where the plan says so.
class EventMotion {
 public:
  /// Keeps references to the island, which it moves, and its ropes. A trial: whether the promise is given up.
  EventMotion(IslandState& island, LimitEvents& ropes, const ChosenMethod& method, bool isTrial);

  /// Takes a step. `frame` (s) is the next time whose state is asked for. Throws Error(unstable) if the state blows up.
  void advance(double frame);

  /// Why events serve the island no more, if they don't: active contacts are not those of spheres, corners and faces,
  /// are too many, or events follow each other too fast. Empty if they do.
  std::string_view fallbackReason() const;

  /// The bodies of the scene that this is about.
  std::vector<int> fallbackBodies() const;

  /// Whether the last step kept the bodies' constraints: its interpolant may be projected.
  bool keepsConstraints() const { return keepsConstraints_; }

  /// s: the end of the first step that constraints were to move by more than the accuracy, if there is one, also if it
  /// was taken again with its stages projected. Near a dead point, where they leave more than one motion, rounding
  /// decides which.
  std::optional<double> offConstraintsFrom() const { return offConstraintsFrom_; }

  /// Contacts that were active over the last step, and what kept bodies at rest then.
  const std::vector<ContactConstraint>& contactsOfStep() const { return contactsOfStep_; }
  std::shared_ptr<const std::vector<SupportForce>> supportsOfStep() const { return supportsOfStep_; }

  /// The bodies of contacts that were active over the last step, and of those that are now.
  const std::vector<BodiesInContact>& bodiesOfStep() const { return bodiesOfStep_; }
  const std::vector<BodiesInContact>& bodiesInContact() const { return contacts_.active().bodies(); }

  /// Ties, pushes and motors that acted in the last step; what ended it may have changed them.
  const Constraints& constraintsOfStep() const { return constraintsOfStep_; }
  const std::vector<PushForce>& pushesOfStep() const { return pushesOfStep_; }
  const std::vector<JointMotor>& motorsOfStep() const { return motorsOfStep_; }

  /// Of the last step, if its own sum of the work of driven bodies may be less exact than asked.
  const std::optional<RunningIntegral>& ledgerOfStep() const { return ledgerOfStep_; }

  /// Whether all bodies of the island lie still.
  bool isAtRest() const;

  /// Lets time pass in which nothing moves.
  void restUntil(double time);

 private:
  bool takeStep(double stepEnd);
  void integrate(double length, double left);
  bool integrateAcrossDeadPoint(double length, double left);
  bool isTooShort();
  bool isSlowAtJoint();
  bool isJammed() const;
  bool noteUnboundedForces();
  /// The event that ends a step: at most one of these.
  struct Event {
    std::optional<ImpactTime> impact;
    std::optional<LimitChange> rope;
    std::optional<ContactChange> contact;
    std::optional<MotorChange> motor;
    double latest = 1;  // of the step: fraction of the event after it
    // s: the length of a step in which there may be no such event, though the interpolant has one; 0: there is no doubt
    double doubtful = 0;
    bool any() const { return impact || rope || contact || motor; }
  };
  Event findFirstEvent();
  Event stopAtFirstEvent();
  void resolveMotors(const std::optional<MotorChange>& change);
  bool stopAtImpact(const ImpactTime& impact);
  template <class Change>
  void endStepBefore(std::optional<Change>& change, double latest, double tolerance, Event& event,
                     const EventFunction& margin);
  void cutAtEvent(Event& event);
  std::optional<double> fractionOfImpact(const ImpactTime& impact);
  double projectedGap(const ImpactTime& impact, const VectorX& state);
  void project(VectorX& state);
  void projectState();
  bool goesFarFromConstraints();
  bool isFarFromConstraints(const VectorX& state) const;
  void requireConstraintsKept();
  bool makeChanges();
  void changeForces(const Event& event);
  void followActive();
  bool applyLimitEvents();
  bool mayEndAnywhere() const;
  bool isStillAccurate();
  std::optional<Event> stepToFirstEvent(double stepEnd);
  double longestStep() const;
  void countEvent(const Event& event);
  [[noreturn]] void failAtManyEvents() const;

  IslandState& island_;
  LimitEvents& ropes_;
  ChosenMethod method_;
  const EventTolerances tolerances_;
  EventContacts contacts_;
  MotorEvents motors_;
  std::optional<EnergyGuard> guard_;  // always there once begun
  ConstraintSolver solver_;
  EventRateLimit eventRateLimit_;
  VectorX tolerance_;
  VectorX projected_;                         // scratch
  double startConstraintError_ = 0;           // m or rad
  double toleranceOfWork_ = INFINITY;         // J, of the last step
  bool isAtDeadPoint_ = false;                // the last step was far off constraints unless its stages were projected
  std::optional<double> offConstraintsFrom_;  // s
  std::optional<RunningIntegral> ledgerOfStep_;
  std::vector<int> tautRowsBefore_;  // of ropes, before an event
  std::vector<ContactConstraint> contactsOfStep_;
  std::vector<BodiesInContact> bodiesOfStep_;
  std::shared_ptr<const std::vector<SupportForce>> supportsOfStep_;
  Constraints constraintsOfStep_;
  std::vector<PushForce> pushesOfStep_;
  std::vector<JointMotor> motorsOfStep_;
  StepSize stepSize_;
  std::array<double, 8> lengths_;  // s: of the last steps, if bodies may touch
  std::size_t lengthIndex_ = 0;
  double longestHeld_ = INFINITY;       // s: of the next step, for what motors hold
  int shortSteps_ = 0, slowSteps_ = 0;  // in a row
  bool areForcesUnbounded_ = false;     // friction is: no step is accurate
  bool isContinuous_ = false;           // nothing has changed the state since the last step's end
  bool keepsConstraints_ = true;        // no rope went taut or slack at the last step's end
  int eventsInWindow_ = 0;
  int changesWithoutTime_ = 0;  // of contacts, in a row
  double windowStart_ = 0;      // s
  const bool isLinkage_;        // whether it may come to a dead point
};

}  // namespace cradle
