#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "impact/contact_delassus.h"
#include "impact/frictional_contact.h"
#include "impact/sparse_delassus.h"
#include "simulate/corrections.h"
#include "simulate/steps/contact_set.h"

namespace cradle {

/// A correction of a step beside the laws of contact.
struct SteppingFault {
  CorrectionKind kind;
  std::vector<int> bodies;  // moving
  double amount;            // in the unit of its kind
};

/// clampEnergy, with a fault if that took energy.
void clampEnergyWithFault(const MovedBodies& moved, double most, const Mechanism& mechanism, VectorX& state,
                          std::vector<SteppingFault>& faults);

/// A contact that took part in a step.
struct SteppedContact {
  Contact contact;              // at the step's start
  Vec3 impulse = Vec3::Zero();  // N s, world, on B
  bool isImpact = false;        // it closed faster than accelerations explain
};

/// The contacts of a step before, with which iterations begin.
struct StepMemory {
  std::vector<SteppedContact> contacts;
  std::vector<Vec3> slips;  // m/s, world: velocities of the contacts with De Saxce's correction
  double ratio = 1;         // of impulses now to those of that step, if forces last
};

/// Numbers of a frictional contact problem (frictional_contact.h): free velocities less the speeds that must remain,
/// and a friction for each contact.
struct ContactProblem {
  VectorX free;  // m/s, components (t1, t2, n) of each contact
  std::vector<double> frictions;
  bool hasRebounds = false;
};

/// The frictional contact problem of one group after the other: dense where contacts are few, else block-sparse. It
/// remembers the step before for warm starts.
class GroupProblem {
 public:
  /// Keeps a reference to `assembly`.
  explicit GroupProblem(const Assembly& assembly)
      : assembly_(assembly),
        constraints_(assembly.mechanism.constraints, assembly.mechanism.bodies),
        held_(ties_, assembly.mechanism.bodies) {}
  GroupProblem(const GroupProblem&) = delete;
  GroupProblem& operator=(const GroupProblem&) = delete;

  /// How far, where bodies have motors, contacts and motors that hold give way: by this part of what their load does
  /// without contacts. Four wheels share their load by it, of which three could bear all and any one could drive the
  /// others. (Where wheels slip, gaps of 1e-9 m may still decide who bears.) Steps have an error of that order anyway.
  /// [1e-4, 1e-3]; with 1e-2 a car climbs 2e-4 too slowly.
  static constexpr double kCompliance = 1e-3;

  /// Lets motors (indices into the mechanism's) hold the velocities of their joints whatever contacts do, until the
  /// next call: their rows are constraints of groups that are set. To be called before `factorize`.
  void hold(const std::vector<std::size_t>& motors);
  bool isHolding() const { return !heldMotors_.empty(); }

  /// The constraints of the bodies, factorised for the state of the last `factorize`.
  ConstraintSolver& constraints() { return constraints_; }
  const ConstraintSolver& constraints() const { return constraints_; }
  void factorize(const VectorX& state);

  /// The same with the motors that hold.
  ConstraintSolver& ties() { return isHolding() ? held_ : constraints_; }

  /// N s or N m s: what the motors that hold give in answer to impulses (N s) at the contacts of the group that was
  /// set, with bodies where they are in `state`.
  VectorX motorImpulses(const VectorX& impulses, const VectorX& state);

  void warmStartFrom(StepMemory memory) { memory_ = std::move(memory); }

  /// Takes a group whose contacts are where `contacts` are now, and bodies where they are in `state`, for which
  /// constraints must be factorised.
  void set(const StepGroup& group, const std::vector<Contact>& contacts, const VectorX& state);
  void set(const StepGroup& group, const VectorX& state) { set(group, group.contacts, state); }

  /// World from the axes (t1, t2, n) of a contact of the group.
  const Mat3& axes(std::size_t contact) const { return sparse_.axes(contact); }

  /// m/s: of the contacts, for the bodies' velocities in `state`.
  VectorX velocitiesIn(const VectorX& state) const { return sparse_.velocitiesIn(state); }

  /// Adds to the bodies' velocities in `state` what impulses (N s) give.
  void apply(const VectorX& impulses, VectorX& state) const {
    dense_ ? dense_->apply(impulses, state) : sparse_.apply(impulses, state);
  }

  /// The inverse mass along a contact's normal, as a fraction of its value without constraints.
  double mobility(std::size_t contact) const { return dense_ ? dense_->mobility(contact) : sparse_.mobility(contact); }

  /// Impulses (N s) that solve the problem for the group that was set; the best that were found, with a fault, if none
  /// do.
  VectorX solve(const StepGroup& group, const ContactProblem& problem, std::vector<SteppingFault>& faults);

  /// Impulses without friction, warm start and faults: of few contacts to rounding, of many to `tolerance` (m/s).
  VectorX solveFrictionless(const VectorX& free, double tolerance);

  /// Iterations of ADMM and interior points so far.
  long iterations() const { return iterations_; }

 private:
  MatrixX delassus() const { return dense_ ? dense_->matrix() : sparse_.matrix(); }
  double motorMobility(const JointMotor& motor, const VectorX& state);
  ContactSolution solveSharing(const VectorX& free, const std::vector<double>& frictions) const;
  ContactSolution solve(const VectorX& free, const std::vector<double>& frictions, double tolerance, WarmStart& start);
  WarmStart warmStartOf(const StepGroup& group) const;
  WarmStart coldStart() const;

  const Assembly& assembly_;
  ConstraintSolver constraints_;
  std::vector<std::size_t> heldMotors_;
  Constraints ties_;               // of the mechanism, then of held motors; empty if there are none of these
  ConstraintSolver held_;          // of ties_
  std::vector<BodyFrame> frames_;  // scratch
  std::vector<Contact> contacts_;  // of the group
  SparseDelassus sparse_;
  bool isSolvedDensely_ = false;          // contacts are few
  std::optional<ContactDelassus> dense_;  // of few contacts of a group with constraints
  StepMemory memory_;
  std::map<int, double> penalties_;  // of ADMM, of each group's first body
  long iterations_ = 0;
};

}  // namespace cradle
