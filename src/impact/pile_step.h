#pragma once

#include <vector>

#include "collision/pair_sweep.h"
#include "core/worker_threads.h"
#include "impact/pile_contacts.h"
#include "impact/soft_contact_solver.h"

namespace cradle {

/// Many bodies that gravity pulls and contact holds, stepped together: fast, accurate enough for the eye. Bodies that
/// lie still with all that they touch sleep, and cost nothing until something wakes them.
class PileStep {
 public:
  /// Keeps a reference to `bodies`. The state's layout is that of dynamics/state.h.
  PileStep(const std::vector<RigidBody>& bodies, ContactGeometry geometry, const Vec3& gravity, int threads);

  /// Moves the state on by `timeStep` (s). What contact takes of the energy is booked as dissipated.
  void advance(double timeStep, VectorX& state);

  bool allAsleep() const { return awake_ == 0; }
  PileContacts& contacts() { return contacts_; }
  const ContactGeometry& geometry() const { return geometry_; }
  PairSweep sweep;

 private:
  void placeBodies(double timeStep, const VectorX& state);
  void moveBodies(double timeStep, VectorX& state);
  void letSleep(double timeStep, VectorX& state);

  const std::vector<RigidBody>& bodies_;
  ContactGeometry geometry_;
  Vec3 gravity_;
  WorkerThreads threads_;
  PileContacts contacts_;
  ContactColoring coloring_;
  SoftContactSolver solver_;
  std::vector<Mat3> principalAxes_;  // columns, body's frame
  std::vector<Vec3> rootMoments_;    // sqrt(kg) m
  std::vector<MovingPose> poses_;
  std::vector<Mat3> principals_;  // worldFromPrincipal
  std::vector<VectorX> dummy_;
  std::vector<SolverBody> solverBodies_;
  SolverMotions motions_;
  std::vector<double> reach_;
  std::vector<Vec3> markedPositions_;
  std::vector<Quat> markedOrientations_;
  std::vector<double> calmTimes_;  // s
  std::size_t awake_ = 0;
};

}  // namespace cradle
