#pragma once

#include <utility>
#include <vector>

#include "simulate/assembly.h"
#include "simulate/steps/group_problem.h"
#include "simulate/steps/next_impact.h"
#include "simulate/steps/step_motion.h"

namespace cradle {

/// Time stepping for many contacts that last or chatter: all contacts within reach of the step are one frictional
/// contact problem for the velocities at its end (J. J. Moreau, 1988). Nothing passes through anything, as a contact
/// that is apart may close by its gap and no more; restitution and friction are included, and energy does not grow.
/// Order 1 where a contact strikes, 2 where contacts last.
class ContactStepping {
 public:
  /// Keeps a reference to `assembly`.
  explicit ContactStepping(const Assembly& assembly)
      : assembly_(assembly), tolerances_(stepTolerancesOf(stepScalesOf(assembly))), problem_(assembly) {}

  /// To be called if free motion goes by a method of order 1.
  void setFirstOrder() { isFirstOrder_ = true; }

  const StepTolerances& tolerances() const { return tolerances_; }

  /// `contacts` are those of the step's start, with gaps that may close within it; `before` is the state there; `state`
  /// is where free motion led after `timeStep` (s), and after the call where contact did, with the energy booked that
  /// went. `ropes` that are no rods take part: they may be as long as they are, as contacts may close. Contacts that
  /// nextImpact found to strike inside the step are not kept apart before its end (`strikesInside`: by contact, or
  /// empty).
  void resolve(const std::vector<Contact>& contacts, const std::vector<const Limit*>& ropes, const VectorX& before,
               double timeStep, VectorX& state, const std::vector<char>& strikesInside = {});

  /// How far (m or rad) the last call left constraints from where they should be.
  double constraintError() const {
    return problem_.constraints().hasConstraints() ? problem_.constraints().largestError() : 0;
  }

  /// The next impact inside a step, with the arguments of `resolve`: of contacts that are apart and close faster than
  /// `minImpactSpeed` (m/s), while those that touch last.
  NextImpact nextImpact(const std::vector<Contact>& contacts, const VectorX& before, double timeStep,
                        const VectorX& state, double minImpactSpeed);

  /// Moves bodies apart that overlap in `state`; the energy that lifts them is taken from their velocities.
  void correctPenetration(const std::vector<Contact>& contacts, const std::vector<const Limit*>& ropes, VectorX& state);

  /// The impact of contacts that touch in `state`, all at once. Their impulses (N s, world, on B). Energy that went is
  /// booked.
  std::vector<Vec3> resolveImpact(const std::vector<Contact>& contacts, double timeStep, VectorX& state);

  /// J: what the friction of active contacts took in the last step, and would have at the velocities of its start.
  struct FrictionWork {
    double atStart = 0, taken = 0;
  };
  FrictionWork frictionWork() const { return frictionWork_; }

  /// N s or N m s, of each motor of the mechanism: what those that hold gave in answer to the contacts of the last
  /// step.
  const VectorX& motorImpulses() const { return motorImpulses_; }

  /// Those of the last step.
  const std::vector<SteppedContact>& contacts() const { return contacts_; }
  /// Iterations that its frictional contact problems took so far.
  long iterations() const { return problem_.iterations(); }

  /// Faults since the last step began, or the last call.
  std::vector<SteppingFault> takeFaults() { return std::exchange(faults_, {}); }

 private:
  /// Velocities to which driven bodies and motors that hold lead others, at the start and the end of a step
  /// (ledVelocities). Empty if there are none.
  struct LedMotion {
    VectorX start, end;
  };
  struct WorkOfDrives {
    double mean = 0;  // J: with the mean of the velocities at both ends
    double most = 0;  // J: with those of one of them, and what solvers leave
  };
  struct StepInput {
    const ContactSet& contacts;
    const FreeStep& step;
    const std::vector<char>& strikesInside;
    const LedMotion& led;
  };
  double impulseRatio(double timeStep) const { return previousStep_ > 0 ? timeStep / previousStep_ : 1; }
  void holdMotors();
  LedMotion ledMotion(const VectorX& before, const VectorX& state);
  double resolveGroup(const StepGroup& group, const StepInput& input, VectorX& state);
  WorkOfDrives workOfDrives(const LedMotion& led, const VectorX& free, const VectorX& impulses) const;
  VectorX move(const StepGroup& group, const StepInput& input, const StepMotion& motion, const VectorX& impulses,
               VectorX& state);
  void keep(const StepGroup& group, const StepMotion& motion, const ContactProblem& posed, const VectorX& impulses,
            const VectorX& state);
  void book(const StepGroup& group, const StepMotion& motion, const VectorX& impulses, const VectorX& end, double loss,
            VectorX& state);

  const Assembly& assembly_;
  StepTolerances tolerances_;
  GroupProblem problem_;
  bool isFirstOrder_ = false;
  std::vector<SteppedContact> contacts_;  // of the last step
  std::vector<Vec3> slips_;               // m/s, world: their velocities with De Saxce's correction
  double previousStep_ = 0;               // s: length of the last step
  std::vector<SteppingFault> faults_;
  std::vector<std::size_t> heldMotors_;  // of the last step
  VectorX motorImpulses_;
  FrictionWork frictionWork_;
};

}  // namespace cradle
