#pragma once

#include <functional>
#include <optional>
#include <variant>
#include <vector>

#include "simulate/conservation_record.h"
#include "simulate/events/event_motion.h"
#include "simulate/joint_coordinates.h"
#include "simulate/steps/stepped_motion.h"
#include "simulate/swept_bodies.h"
#include "trajectory/trajectory.h"

namespace cradle {

constexpr double kTrialTime = 0.05;  // s: after that, contacts that were too much for events are tried again

/// An island in motion, with a clock of its own. Time goes on in steps of the method.
class IslandSolver {
 public:
  /// Keeps a reference to `scene`. The method is one that takes steps. `promiseEnd`: of bodies of the island before it
  /// began to move; it begins in contact steps then.
  IslandSolver(const Scene& scene, Assembly assembly, const ChosenMethod& method,
               std::optional<PromiseEnd> promiseEnd = {});
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

  /// Begins to note what the bodies sweep until `to` (s), from the last call of stateAt on; that must not be beyond
  /// `to`.
  void beginSweep(double to);

  /// Since the last call of beginSweep, up to the last call of stateAt.
  const SweptBodies& swept() const { return swept_; }

  /// To be called after the last frame: the accuracy asked was not kept if energy or momenta of the frames changed by
  /// more than kMaxNumericalRatio times the accuracy without a cause.
  void finish();

  /// The hinges and sliders of the assembly in that state. In steps of one length a motor's force is that of the step.
  const std::vector<JointState>& jointStates() const { return jointStates_; }

  const Assembly& assembly() const { return island_.assembly; }
  long evaluations() const { return island_.equations.evaluations() + frameEquations_.evaluations(); }

  /// Events since the last call: up to the end of the step under way.
  std::vector<Event> takeEvents() { return island_.log.take(); }
  std::vector<std::string> takeWarnings() { return island_.log.takeWarnings(); }
  Corrections& corrections() { return island_.log.corrections(); }

  /// Set from when on the accuracy asked is not promised any more.
  const std::optional<PromiseEnd>& promiseEnd() const { return promiseEnd_; }

 private:
  void advance(double time);
  void changeMotion();
  void changeToSteps();
  double contactTimeStep() const;
  void endPromise(const EventMotion& events);
  void endPromiseAtDeadPoint(double time);
  template <class Motion>
  static void advance(double time, Motion& motion);
  bool mayNotGoOn() const;
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
  void withForcesOfStep(const EventMotion& events, const Evaluate& evaluate);
  void findJointStates(double time);
  VectorX motorForces(double time);
  void setResting(const std::vector<char>& resting);
  void project(const std::vector<ContactConstraint>& contacts);
  void findStill();
  void rotate(Eigen::Index body, double time, VectorX& state) const;

  IslandState island_;
  LimitEvents ropes_;
  JointCoordinates coordinates_;
  ConstraintSolver solver_;
  EquationsOfMotion frameEquations_;  // for what is asked of frames: the motion knows nothing of it
  std::variant<std::monostate, EventMotion, SteppedMotion> motion_;
  ChosenMethod method_;
  ConservationRecord record_;
  std::optional<PromiseEnd> promiseEnd_;
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
