#pragma once

#include <vector>

#include "collision/broad_phase.h"
#include "core/worker_threads.h"
#include "impact/soft_contact_solver.h"
#include "impact/soft_contacts.h"
#include "impact/soft_sleep.h"

namespace cradle {

/// Many bodies that gravity pulls and contact holds, stepped together: fast, and accurate enough for the eye. Bodies
/// that lie still with all that they touch sleep, and cost nothing until something touches them. The result does not
/// depend on the number of threads.
class SoftStep {
 public:
  /// Keeps references to bodies and geometry, whose pairs it refreshes. All bodies are awake.
  SoftStep(const std::vector<RigidBody>& bodies, ContactGeometry& geometry, const Vec3& gravity, int threads);

  /// Bodies of colliders that are driven are led: gravity does not pull them, and they go through a step with the
  /// velocity that they have at its start, save for what contacts do to a body as heavy as they are said to be. Moves
  /// the state (layout of dynamics/state.h; orientations of unit length) on by `timeStep` (s), at most 1/60 (by the
  /// scale) for heaps to stay still. Orientations stay of unit length; the ledger is left as it is.
  void advance(double timeStep, VectorX& state);

  /// What goes from step to step beside the state.
  struct Record {
    SoftSleep::Record sleep;
    std::vector<SoftContacts::Record> contacts;
    bool isDisturbed = false;
  };
  Record record() const { return {sleep_.record(), contacts_.record(poses_), isDisturbed_}; }

  /// To be called before the first step.
  void goOnFrom(const Record& record, const VectorX& state);

  const SoftScale& scale() const { return scale_; }
  bool allAsleep() const { return sleep_.awake() == 0; }
  std::size_t awake() const { return static_cast<std::size_t>(sleep_.awake()); }  // bodies
  bool isAsleep(std::size_t body) const { return sleep_.isAsleep(body); }
  /// The contacts of the last detection.
  const SoftContacts& contacts() const { return contacts_; }
  /// What contacts of bodies awake did after the last detection, by manifolds.
  std::vector<SoftContactSolver::MeanLoad> meanLoads() const { return solver_.meanLoads(contacts_.manifolds().size()); }
  /// What contacts do that hold all bodies still where they are, by manifolds: in the mean of so many sub-steps from
  /// rest, which change nothing. What these leave of the velocities is small, as all that sleep are near rest.
  std::vector<SoftContactSolver::MeanLoad> loadsAtRest(int subSteps);

  /// How often contacts were detected so far.
  long detections() const { return detections_; }

  /// What happened in the last step: bodies that met faster than gravity makes them in a step, and bodies that fell
  /// asleep or were woken.
  struct Impact {
    ColliderPair pair;
    Vec3 point, normal;  // m, world; unit, from A to B
    double impulse;      // N s
  };
  const std::vector<Impact>& impacts() const { return impacts_; }
  const std::vector<int>& fallenAsleep() const { return fallenAsleep_; }
  const std::vector<int>& woken() const { return woken_; }

  /// What contacts took of the energy in the last step.
  const SoftContactSolver::Taken& taken() const { return taken_; }

 private:
  void placeBodies(double timeStep, const VectorX& state);
  void putToSleep(std::size_t body);
  double maxMargin() const;  // m: pairs farther apart do not touch within a step
  void placeBody(std::size_t index, const VectorX& state);
  SolverBody solverBody(std::size_t index) const;
  SolverBody stillBody(std::size_t index) const;
  void takeSubstepGroup(double timeStep, int subSteps, int substepGroups, VectorX& state);
  void moveBody(std::size_t index, double timeStep, double subStep, VectorX& state);
  void recordImpacts(double timeStep);
  void wakeLed(const VectorX& state);
  SolverMotions::Pull pullOf(std::size_t body) const {
    return isLed_[body] ? SolverMotions::Pull::none : SolverMotions::Pull::gravity;
  }
  void wakeTouched(const SoftStepStart& look);
  void letSleep(double timeStep, VectorX& state);

  const std::vector<RigidBody>& bodies_;
  ContactGeometry& geometry_;
  const Vec3 gravity_;
  WorkerThreads threads_;
  const SoftScale scale_;
  BroadPhase broadPhase_;
  SoftContacts contacts_;
  ContactColoring coloring_;
  SoftContactSolver solver_;
  std::vector<Mat3> principalAxes_;  // columns, body's frame
  std::vector<Vec3> rootMoments_;    // sqrt(kg) m
  std::vector<MovingPose> poses_;
  std::vector<Bounds> bounds_;  // m, of the colliders, body's frame
  std::vector<char> isSphere_, isLed_, isLedStill_;
  std::vector<Mat3> worldFromPrincipal_;
  std::vector<SolverBody> solverBodies_;
  SolverMotions motions_;
  std::vector<Vec3> displacements_;  // m: ways of the bodies in the step, if nothing deflects them
  std::vector<double> reaches_;      // m: farthest that any point of a body goes beside them
  SoftSleep sleep_;
  std::vector<double> speeds_;  // m/s, of each body's fastest point; infinite if it touches nothing
  double slowestRebound_ = 0;   // m/s
  bool rebounds_ = false;       // by some law
  bool hasManySpheres_ = false;
  bool isDisturbed_ = false;  // at the end of the last step
  double margin_ = 0;         // m: nearer bodies are in contact
  double slow_ = 0;           // m/s: slower is as good as still
  long detections_ = 0;
  std::vector<Impact> impacts_;
  std::vector<int> fallenAsleep_, woken_;
  SoftContactSolver::Taken taken_;
};

}  // namespace cradle
