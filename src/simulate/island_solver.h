#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "simulate/conservation_record.h"
#include "simulate/contact_wrenches.h"
#include "simulate/events/event_motion.h"
#include "simulate/joint_coordinates.h"
#include "simulate/steps/stepped_motion.h"
#include "simulate/swept_bodies.h"
#include "simulate/world_record.h"
#include "trajectory/trajectory.h"

namespace cradle {

constexpr double kTrialTime = 0.05;  // s: after that, contacts that were too much for events are tried again

/// An island in motion, with a clock of its own. Time goes on in steps of the method.
class IslandSolver {
 public:
  /// Keeps a reference to `scene`. The method is one that takes steps.
  IslandSolver(const Scene& scene, Assembly assembly, const ChosenMethod& method);

  /// One of several, which are judged together: finish does nothing. Contact steps of before go on.
  IslandSolver(const Scene& scene, Assembly assembly, const ChosenMethod& method, IslandHistory history);

  /// One of the plan that goes on.
  IslandSolver(const Scene& scene, Assembly assembly, const ChosenMethod& method, const IslandRecord& record);
  IslandSolver(const IslandSolver&) = delete;
  IslandSolver& operator=(const IslandSolver&) = delete;

  /// The state at `time` (s), not earlier than in the call before, and not after the end of the scene; orientations of
  /// unit length. At an instant of events the state after them. Throws Error(unstable) if the state blows up,
  /// Error(limit) if a step has too many impacts, Error(interrupted). `reached` is told the time (s) after each step;
  /// it may be none.
  const VectorX& stateAt(double time, const std::function<void(double time)>& reached = {});

  /// The state of the last call of stateAt again, at events as exact as an event's: of a step that ends there, and not
  /// of an interpolant.
  const VectorX& stepToReported();

  /// From now on no step goes beyond `time` (s).
  void stopAt(double time) { island_.lastStepEnd = time; }

  /// s: the end of the last step.
  double clock() const { return island_.time; }

  bool isResting(std::size_t body) const { return island_.equations.isResting(body); }

  /// Begins to note what the bodies sweep until `to` (s), from the last call of stateAt on; that must not be beyond
  /// `to`.
  void beginSweep(double to);

  /// Since the last call of beginSweep, up to the last call of stateAt.
  const SweptBodies& swept() const { return swept_; }

  /// Frees memory that the next step takes again.
  void releaseScratch() {
    releaseStages(island_.step);
    frameStep_ = {};
  }

  /// To be called after the last frame: the accuracy asked was not kept if energy or momenta of the frames changed by
  /// more than kMaxNumericalRatio times the accuracy without a cause.
  void finish();

  /// The hinges and sliders of the assembly in that state. In steps of one length a motor's force is that of the step.
  const std::vector<JointState>& jointStates() const { return jointStates_; }

  /// What lasting contacts do in the state of the last call of stateAt; in steps of one length, their mean over the
  /// last StepContacts::kContactTime. A contact that a joint holds is a constraint, and not among them.
  std::vector<ContactWrench> contactWrenches();

  const Assembly& assembly() const { return island_.assembly; }
  /// Those of contactWrenches are left out: islands part by what their motion costs, which must not depend on what is
  /// asked of it.
  long evaluations() const {
    return island_.equations.evaluations() + (frameEquations_ ? frameEquations_->evaluations() : 0) -
           evaluationsOfLoads_;
  }

  /// Evaluations times bodies, where contact is solved over steps a multiple of that: about as long as it took.
  long work() const { return work_; }

  /// Events since the last call: up to the end of the step under way.
  std::vector<Event> takeEvents() { return island_.log.take(); }
  std::vector<std::string> takeWarnings() { return island_.log.takeWarnings(); }
  Corrections& corrections() { return island_.log.corrections(); }

  /// Set from when on the accuracy asked is not promised any more.
  const std::optional<PromiseEnd>& promiseEnd() const { return promiseEnd_; }

  /// Pushes that act at a time (s) up to the last step's end.
  std::vector<StartedPush> pushesAt(double time) const { return island_.pushes.startedBy(time); }

  /// Impacts with bumps of each scene body, up to the last step's end.
  BumpCounts bumpCounts() const { return island_.bumps.countsBy(island_.time); }

  /// To go on from, of one of the plan, in the state of the last call of stateAt, which is that at a step's end.
  IslandRecord record() const;

  /// Takes the events of its first instant, of one that goes on with bodies that moved before: what was told then is
  /// left out. `isToldResting`: by scene body.
  std::vector<Event> takeFirstEvents(const std::vector<char>& isToldResting);

  /// What an island goes on with that begins from the last step's end; of its impacts those by `time` (s), which is not
  /// after that.
  IslandHistory history(double time) const {
    const bool leavesEvents = events_ && !events_->fallbackReason().empty();
    return {promiseEnd_,
            hasLeftEvents_ || leavesEvents,
            steps_ != nullptr || leavesEvents,
            island_.bumps.countsBy(time),
            {}};
  }

  /// Those bodies that move together in it, in the state of the last call of stateAt, which is that at a step's end; of
  /// no clusters.
  PartRecord partRecord() const;

 private:
  void advance(double time);
  void changeMotion();
  void changeToSteps();
  void moveByEvents(bool isTrial);
  void moveBySteps(const ChosenMethod& steps);
  double contactTimeStep() const;
  void endPromise(const EventMotion& events);
  void endPromiseAtDeadPoint(double time);
  void endPromise(const Correction& correction);
  template <class Motion>
  static void advance(double time, Motion& motion);
  bool keepsConstraints() const;
  bool isVisual() const { return island_.scene.accuracy > kVisualAccuracy; }
  /// The state of a frame inside a step. Its difference from the energy of the step's start is an error of that frame
  /// alone.
  void report(double time, bool byStep);
  void interpolateAt(double time, bool byStep);
  bool mayFrictionTurn(const std::vector<ContactConstraint>& contacts) const;
  void stepWhereForcesJump(double time);
  void stepTo(double time);
  /// Calls evaluate() with contacts, constraints, pushes and motors as they were in the last step of events.
  template <class Evaluate>
  void withForcesOfStep(const Evaluate& evaluate);
  void findJointStates(double time);
  VectorX motorForces(double time);
  void addActiveLoads(bool isInside, WrenchSum& sum);
  /// For what is asked of frames: the motion knows nothing of them.
  EquationsOfMotion& frameEquations();
  void setResting(const std::vector<char>& resting);
  void project(const std::vector<ContactConstraint>& contacts);
  void findStill();
  void rotate(Eigen::Index body, double time, VectorX& state) const;

  IslandState island_;
  LimitEvents ropes_;
  JointCoordinates coordinates_;
  ConstraintSolver solver_;
  std::unique_ptr<EquationsOfMotion> frameEquations_;  // none before they are asked for
  long evaluationsOfLoads_ = 0;
  long work_ = 0;
  std::unique_ptr<EventMotion> events_;   // or ...
  std::unique_ptr<SteppedMotion> steps_;  // ... what moves the island
  ChosenMethod method_;
  std::optional<ConservationRecord> record_;  // unless others judge the island
  std::optional<PromiseEnd> promiseEnd_;
  bool hasLeftEvents_;             // once: events that come back are a trial
  double nextTrial_ = 0;           // s: when events may serve again
  double trialTime_ = kTrialTime;  // s: until then; longer each time that they did not
  std::vector<char> still_;        // bodies that the step has not moved
  VectorX reported_, derivative_;
  double reportedTime_ = 0;  // s
  SweptBodies swept_;        // if it is asked for
  bool isSwept_ = false;
  Step frameStep_;  // that ends at a frame
  std::vector<JointState> jointStates_;
};

}  // namespace cradle
