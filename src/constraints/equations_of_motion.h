#pragma once

#include <vector>

#include "constraints/contact_forces.h"
#include "constraints/joint_motor.h"
#include "dynamics/driven_body.h"
#include "dynamics/integrators/step.h"
#include "dynamics/push.h"
#include "dynamics/spring.h"

namespace cradle {

/// Moving bodies and everything smooth that acts on them.
struct Mechanism {
  Vec3 gravity = Vec3::Zero();  // m/s^2
  std::vector<RigidBody> bodies;
  std::vector<SpringForce> springs;
  Constraints constraints;
  std::vector<PushForce> pushes;                 // those that act now
  std::vector<ContactConstraint> contacts = {};  // those that last and are loaded
  std::vector<DrivenBody> driven = {};           // of the bodies
  std::vector<JointMotor> motors = {};
};

/// The equations of motion of a mechanism in the layout of state.h:
///   x' = v, q' = 1/2 (0, w) q, m v' = f, body frame: I w' = T - w x I w (Newton, Euler), constraints by their forces.
/// Bodies marked as resting do not move, whatever acts on them.
class EquationsOfMotion {
 public:
  /// Keeps a reference to `mechanism`.
  explicit EquationsOfMotion(const Mechanism& mechanism);

  /// State derivative at `time` (s), at which driven bodies are where `state` says. Allocates only in its first call.
  void evaluate(double time, const VectorX& state, VectorX& derivative);

  /// The same without contacts, for what is to find their forces: motors that hold have the forces that they had last.
  void evaluateWithoutContacts(double time, const VectorX& state, VectorX& derivative);

  void setResting(std::size_t body, bool resting);
  bool isResting(std::size_t body) const { return resting_[body] != 0; }
  const std::vector<char>& resting() const { return resting_; }

  /// Whether nothing moves the ends of a constraint: those of it that are bodies rest or are driven.
  bool isResting(const Constraint& constraint) const;

  /// Multipliers of the constraints' rows at the last evaluation, in their order: a rod pushes its ends apart with the
  /// force (N) multiplier x length.
  const VectorX& multipliers() const { return multipliers_; }

  /// What acts at each contact, at the last evaluation. Contacts between bodies at rest have no force here.
  const std::vector<ContactForce>& contactForces() const { return contactSolver_.forces(); }

  /// Forces (N or N m) of the motors at the last evaluation (where bodies rest, at the last before that), and what 1 of
  /// it adds to the acceleration of the coordinate, 1/kg or 1/(kg m^2); the latter of those that hold alone.
  const VectorX& motorForces() const { return motorForces_; }
  const VectorX& motorMobilities() const { return motorMobilities_; }

  /// By how much motors that hold miss the accelerations that keep their targets, at the last evaluation that found
  /// forces, where wheels or cranks depend on each other: above 1 their targets contradict each other, and some of the
  /// motors have to push with all their force.
  const VectorX& motorContradictions() const { return motorContradictions_; }

  /// The forces (N or N m) that motors with a target velocity can have at `time` (s), in their order, whatever their
  /// mode: those whose joints are off the target push with all they have; the others, all together, give what keeps
  /// their joints at it, or all they have where that does not suffice. Off is what misses it by more than settledSpeed,
  /// of all motors but those that have `reached` their targets (a flag for each; empty: none). Motors of bodies at
  /// rest, and constant ones, have the forces that they have.
  VectorX possibleMotorForces(double time, const VectorX& state, const std::vector<char>& reached);

  /// How fast (1/s) motors that hold take back what their joint's velocity is off. Steps of a fixed length do so within
  /// one, and with at most the force that motors have; others locate the instants from which that does not suffice.
  void setMotorSteps(double timeStep) { motorTimeStep_ = timeStep; }
  double motorSteps() const { return motorTimeStep_; }  // s; 0: of no fixed length

  /// Gives motors that hold the impulses that bring their joints to their targets, with all constraints and contacts:
  /// what a step, its interpolant, or the search for the instant of the target has left. Changes velocities alone;
  /// the last evaluation's forces of contacts and constraints are not known any more.
  void keepTargets(VectorX& state);

  /// Moves the bodies by the least (mass-weighted) motion until constraints and contacts hold to rounding, and takes
  /// out of the velocities what would change that or makes sticking contacts slide. Returns the largest error that was
  /// found, in m or rad.
  double project(VectorX& state);

  /// Whether states are projected before they are evaluated. Near a dead point, where constraints nearly leave one more
  /// motion, stages off their manifold have accelerations without bound.
  void setProjecting(bool projects) { projects_ = projects; }

  /// How often evaluate was called.
  long evaluations() const { return evaluations_; }

  /// As integrators take it; refers to this object.
  RightHandSide rightHandSide();

 private:
  void evaluateAt(double time, const VectorX& state, VectorX& derivative);
  void applyGravityAndGyroscopicTerms(const VectorX& state, VectorX& derivative) const;
  void applySprings(const VectorX& state, VectorX& derivative) const;
  void applyPushes(const VectorX& state, VectorX& derivative) const;
  bool hasContacts() const { return !isWithoutContacts_ && !mechanism_.contacts.empty(); }
  void applyConstraints(double time, const VectorX& state, VectorX& derivative);
  void factorize(double time, const VectorX& state);
  void constrain(VectorX& derivative);
  void applyMotors(const VectorX& state, VectorX& derivative);
  bool isStopped(const JointMotor& motor) const;
  /// What motors do to their coordinates, with all constraints and contacts.
  struct MotorResponse {
    VectorX free;      // rad/s^2 or m/s^2: accelerations without their forces
    MatrixX perForce;  // what 1 of each force adds
    double scale = 0;  // rad/s^2 or m/s^2: bound on the terms of `free`, of which 1e-16 and more is its rounding
  };
  MotorResponse responseOf(const std::vector<std::size_t>& holding, const std::vector<ConstraintBlock>& rows,
                           const VectorX& state, const VectorX& derivative);
  double scaleOf(const std::vector<std::size_t>& holding, const std::vector<ConstraintBlock>& rows,
                 const VectorX& state, const VectorX& derivative) const;
  void leaveOutBlocked(const std::vector<ConstraintBlock>& rows, MatrixX& perForce) const;
  VectorX missingVelocities(const std::vector<std::size_t>& holding, const std::vector<ConstraintBlock>& rows,
                            const VectorX& state) const;
  VectorX limitsOf(const std::vector<std::size_t>& holding) const;
  VectorX possibleForces(const std::vector<std::size_t>& holding, const MotorResponse& response,
                         const VectorX& missing) const;
  static VectorX contradictionOf(const MotorResponse& response, const VectorX& forces, const VectorX& wanted);
  void hold(const std::vector<std::size_t>& holding, const std::vector<ConstraintBlock>& rows, const VectorX& state,
            VectorX& derivative);
  void addForce(const ConstraintBlock& row, double force, const VectorX& state, VectorX& derivative) const;
  void holdResting(const VectorX& state, VectorX& derivative) const;
  void addForce(int body, const Vec3& arm, const Vec3& force, const VectorX& state, VectorX& derivative) const;
  void addPowerOfConstraints(const VectorX& state, VectorX& derivative) const;
  void addPowerOfContacts(const VectorX& state, VectorX& derivative) const;

  const Mechanism& mechanism_;
  std::vector<char> resting_;
  std::vector<BodyFrame> frames_;
  ConstraintSolver solver_;  // without contacts
  ContactSolver contactSolver_;
  VectorX multipliers_;
  VectorX motorForces_, motorMobilities_, motorContradictions_;
  bool isWithoutContacts_ = false;  // in the evaluation under way
  bool projects_ = false;
  VectorX projected_;
  double motorTimeStep_ = 0;   // s; 0: motors hold without a limit
  bool asksPossible_ = false;  // what motors can give, whatever their modes
  std::vector<char> reached_;  // of each motor: it is at its target then
  long evaluations_ = 0;
};

/// Rates of positions and orientations alone, from the velocities in `state`: writes the leading entries of
/// `derivative`.
void evaluatePoseRates(const std::vector<RigidBody>& bodies, const VectorX& state, VectorX& derivative);

}  // namespace cradle
