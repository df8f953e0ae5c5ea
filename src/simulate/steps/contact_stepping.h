#pragma once

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "collision/root_bracketing.h"
#include "dynamics/rigid_body.h"
#include "impact/dense_contact_problem.h"
#include "impact/pairwise.h"
#include "impact/sparse_contact_problem.h"
#include "simulate/assembly.h"
#include "simulate/corrections.h"
#include "simulate/rope_events.h"
#include "simulate/steps/contact_energy.h"

namespace cradle {

/// A contact that took part in a step.
struct SteppedContact {
  Contact contact;              // at the step's start
  Vec3 impulse = Vec3::Zero();  // N s, world, on B
  bool isImpact = false;        // it closed faster than what accelerations explain
};

/// What had to be done to a step beside the laws of contact.
struct SteppingFault {
  CorrectionKind kind;
  std::vector<int> bodies;  // moving
  double amount;            // in the unit of its kind
};

/// The contact step for many contacts that last or chatter: all contacts within reach of the step are one frictional
/// contact problem for the velocities at its end. Nothing passes through anything (what is apart may close by its gap
/// and no more), restitution and friction included, and energy does not grow. Order 1 where something strikes, 2 where
/// contacts last.
class ContactStepping {
 public:
  /// Keeps a reference to `assembly`.
  explicit ContactStepping(const Assembly& assembly);

  /// `contacts` are those of the step's start, with gaps that may close within it; `before` the state there; `state`
  /// where free motion led after `timeStep` (s), and after the call where contact did. Energy that went is booked.
  /// What nextImpact found to land is not held before the step's end. `ropes` that are no rods take part: they may be
  /// as long as they are, as contacts may close.
  void resolve(const std::vector<Contact>& contacts, const std::vector<const RopeLimit*>& ropes, const VectorX& before,
               double timeStep, VectorX& state);

  /// How far (m or rad) the last call left constraints from where they should be.
  double constraintError() const { return solver_.hasConstraints() ? solver_.largestError() : 0; }

  /// The part of a step, with the same arguments, after which something lands first: what is apart meets, faster than
  /// at `minImpactSpeed` (m/s), while what touches is held. Infinite if nothing does.
  double nextImpact(const std::vector<Contact>& contacts, const VectorX& before, double timeStep, const VectorX& state,
                    double minImpactSpeed);

  /// Moves bodies apart that overlap in `state`; what lifts them is taken from their velocities.
  void correctPenetration(const std::vector<Contact>& contacts, const std::vector<const RopeLimit*>& ropes,
                          VectorX& state);

  /// The impact of contacts that touch in `state`, all at once. Their impulses (N s, world, on B). Energy that went is
  /// booked.
  std::vector<Vec3> strike(const std::vector<Contact>& contacts, double timeStep, VectorX& state);

  /// J: what the friction of active contacts took in the last step, and would have at the velocities of its start.
  struct FrictionWork {
    double atStart = 0, taken = 0;
  };
  FrictionWork frictionWork() const { return frictionWork_; }

  /// Those of the last step.
  const std::vector<SteppedContact>& contacts() const { return contacts_; }
  /// Iterations that its frictional contact problems took so far.
  long iterations() const { return iterations_; }

  /// Faults since the last step began, or the last call.
  std::vector<SteppingFault> takeFaults() { return std::exchange(faults_, {}); }

 private:
  static constexpr std::size_t kFewContacts = 6;  // solved densely, to rounding
  static constexpr double kFractionError = 1e-6;  // of restitutions that are scaled: impulses are found no better
  struct Group {
    std::vector<std::size_t> members;  // of contacts_
    std::vector<Contact> contacts;     // the same
    MovedBodies moved;
    int firstBody = 0;
    bool isConstrained = false;
  };
  struct Motion {
    const VectorX& before;  // the state at the step's start
    VectorX start, free;  // m/s: of the contacts where they are in its middle, for velocities there and of free motion
    VectorX velocityProduct;  // m/s: what bodies that keep their velocities add to that in half the step
    double timeStep;          // s
    double closing(Eigen::Index normal) const {
      return velocityProduct[normal] - start[normal];
    }                                             // m/s, at the step's start
    double pressing(Eigen::Index normal) const {  // m/s: what the step adds to that
      return std::max(0.0, -closing(normal) - free[normal] - velocityProduct[normal]);
    }
  };
  struct Problem {
    VectorX free;  // m/s, less the speeds that must remain
    std::vector<double> frictions;
    bool hasRebounds = false;
  };
  void setMiddle(const VectorX& before, double timeStep);
  void begin(const std::vector<Contact>& contacts, const std::vector<const RopeLimit*>& ropes, const VectorX& before,
             double timeStep, const VectorX& state);
  std::size_t firstRope() const { return contacts_.size() - ropes_.size(); }
  bool isRope(std::size_t member) const { return member >= firstRope(); }
  Vec3 follow(std::size_t member, const VectorX& before, double timeStep, Contact& contact) const;
  Vec3 followSides(double timeStep, Contact& contact) const;
  const ContactMaterial& materialOf(std::size_t member) const;
  void setContactProblem(const Group& group, const VectorX& state);
  void setContactProblem(const Group& group, const std::vector<Contact>& contacts, const VectorX& state);
  Motion motionOf(const Group& group, const VectorX& before, double timeStep, const VectorX& state);
  bool isOnSmoothPlane(std::size_t member) const;
  std::vector<Group> findGroups() const;
  double restSpeed(double pressing, double timeStep) const;
  void resolve(const Group& group, const VectorX& before, double timeStep, VectorX& state);
  Problem posed(const Group& group, const Motion& motion, double part) const;
  bool markImpactsInside(const Group& group, const Motion& motion, double minImpactSpeed);
  double fractionOfImpact(const Group& group, const Motion& motion, const VectorX& end);
  Problem posedImpact(const Group& group, const VectorX& start, double timeStep, double part) const;
  bool slide(const Group& group, const VectorX& end, Problem& problem) const;
  VectorX strike(const Group& group, double timeStep, VectorX& state);
  template <class LossWith>
  static double fractionWithoutGain(const LossWith& lossWith, double lossOfAll);
  VectorX solve(const Group& group, const Problem& problem);
  MatrixX delassus() const { return dense_ ? dense_->delassus() : sparse_.delassus(); }
  void limit(const Group& group, double most, VectorX& state);
  void forgetFaults(std::size_t kept) {
    faults_.erase(faults_.begin() + static_cast<std::ptrdiff_t>(kept), faults_.end());
  }
  void noteUnsolved(const Group& group, const ContactSolution& solution, double tolerance);
  WarmStart startOf(const Group& group) const;
  VectorX move(const Group& group, const Motion& motion, const VectorX& impulses, VectorX& state);
  static VectorX gapsAfter(const Group& group, double timeStep, const VectorX& velocities);
  void moveByMean(const Group& group, const Motion& motion, VectorX& state) const;
  void separate(const Group& group, const VectorX& gaps, VectorX& state);
  void restore(const std::vector<int>& bodies, VectorX& state) const;
  void keep(const Group& group, const Motion& motion, const Problem& problem, const VectorX& impulses,
            const VectorX& state);

  void book(const Group& group, const Motion& motion, const VectorX& impulses, const VectorX& end, double loss,
            VectorX& state);
  void bookForces(double timeStep, VectorX& state) const;

  const Assembly& assembly_;
  ConstraintSolver solver_;      // of the step's middle
  double overlapTolerance_ = 0;  // m
  SparseContactProblem sparse_;
  std::optional<DenseContactProblem> dense_;  // of a group with constraints
  std::vector<SteppedContact> contacts_, previous_;
  std::vector<const RopeLimit*> ropes_;         // the last of contacts_ within a step
  std::vector<ContactMaterial> ropeMaterials_;  // theirs
  std::vector<char> strikesInside_;             // contacts that are not held before the step's end
  std::vector<Vec3> slips_, previousSlips_;     // m/s, world: velocities of the contacts with De Saxce's correction
  double previousStep_ = 0, startPart_ = 1;     // s; ratio of impulses now to those of the step before, if forces last
  std::map<int, double> penalties_;             // of each group's first body
  long iterations_ = 0;
  std::vector<SteppingFault> faults_;
  FrictionWork frictionWork_;
  VectorX free_;                   // where free motion led
  VectorX middle_;                 // where bodies are in the middle of the step, with the velocities of its start
  std::vector<BodyFrame> frames_;  // there
};

/// The largest part of the restitutions with which no energy is gained. `lossWith(part)` is what an impact then takes
/// (J), < 0 with all of them.
template <class LossWith>
double ContactStepping::fractionWithoutGain(const LossWith& lossWith, double lossOfAll) {
  Bracket parts{0, lossWith(0), 1, lossOfAll};
  if (parts.gapBefore > 0) closeBracket(lossWith, parts, kFractionError);
  return parts.before;
}

}  // namespace cradle
