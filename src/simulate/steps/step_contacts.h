#pragma once

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "constraints/disjoint_sets.h"
#include "impact/pairwise.h"
#include "simulate/contact_wrenches.h"
#include "simulate/island_state.h"
#include "simulate/limit_events.h"
#include "simulate/steps/contact_stepping.h"

namespace cradle {

/// Contacts of an island under time stepping: contacts that last are solved over a step, impacts are resolved at its
/// end, and bodies in equilibrium are put to rest.
class StepContacts {
 public:
  /// Keeps a reference to `island`. The method has a fixed step.
  StepContacts(IslandState& island, const ChosenMethod& method);

  /// Finds the contacts that may close within a step of free motion of `length` (s) from `before` to `state`, and wakes
  /// the bodies of those that do.
  void begin(double time, const VectorX& before, const VectorX& state, double length);

  /// Near pairs without a contact of the step: impacts of these are searched for.
  std::vector<ColliderPair> pairsWithoutContact() const;

  /// The fraction of that step at which the next impact inside it comes, whose contacts are then resolved after the
  /// step; infinite if there is none.
  double nextImpact(const VectorX& before, const VectorX& state, double length);

  /// Solves the contacts of a step that has begun, now of this `length` (s), as one frictional contact problem, with
  /// `ropes` that may be stretched in it. `state` is the end of free motion, and after the call that of the step.
  void solveContacts(const VectorX& before, double length, const LimitEvents& ropes, VectorX& state);

  /// J: what friction took in the step that was solved last, and would have at the velocities of its start.
  ContactStepping::FrictionWork frictionWork() const { return stepping_.frictionWork(); }

  /// N s or N m s, of each motor: what those that hold gave in answer to the contacts of that step.
  const VectorX& motorImpulses() const { return stepping_.motorImpulses(); }

  /// How far (m or rad) that left constraints from where they should be.
  double constraintError() const { return stepping_.constraintError(); }

  /// Records the impacts within the step that was solved last, and puts to rest bodies that are still at its end.
  void recordAndLetSleep(double time, VectorX& state);

  /// Impulses of the contacts of the last step, and of impacts at its end, that were not told as events: of contacts
  /// that last. To be called at the end of each step.
  std::vector<ContactLoad> takeLoads();

  /// The impacts of this instant. `before` is the state at the step's start.
  void resolveImpacts(double time, const VectorX& before, LimitEvents& ropes, VectorX& state);

  /// The contacts of the last step, or those at its end, between bodies of which one moved.
  const std::vector<Contact>& touching() const { return touching_; }

  /// Whether a contact struck within the last step, and not at its end.
  bool hasImpact() const;

  /// Whether time stepping alone resolves impacts, as many contacts last or chatter: they are not searched for then.
  bool usesTimeSteppingOnly() const { return stepsOnly_; }
  void useTimeSteppingOnly() { willStepOnly_ = true; }

  const StepTolerances& tolerances() const { return stepping_.tolerances(); }

  /// s: an impact of bodies that press each other already is part of their contact, if the lighter one's weight gives
  /// as much in that time; forces of contacts have their mean over it, as those of single steps rattle.
  static constexpr double kContactTime = 1.0 / 60;

 private:
  void findTouching(const VectorX& state, const std::function<double(int, int)>& marginOf,
                    std::vector<Contact>& touching);
  void findTouching(const VectorX& state, double margin, std::vector<Contact>& touching);
  void eraseHeld(const VectorX& state, std::vector<Contact>& contacts);
  void loosenShortMomentArms(const VectorX& state, std::vector<Contact>& contacts);
  void correctPenetrations(const LimitEvents& ropes, VectorX& state);
  void findWithinReach(const VectorX& before, const VectorX& state, double length);
  void findStepContacts(const VectorX& before, const VectorX& state, double length);
  void findSimultaneous(const VectorX& state);
  double lightest(const Contact& contact) const;
  void record(double time, const Contact& contact, const Vec3& impulse, bool isImpact);
  void letSleep(double time, const std::vector<Contact>& contacts, VectorX& state);
  void recordFaults(double time);
  void wakeTouched(double time, const VectorX& state);
  void resolveImpactIslands(double time, const VectorX& before, VectorX& state);
  void resolveWithBumps(double time, std::vector<ImpactContact>& impacts, VectorX& state);
  DisjointSets findImpactIslands() const;
  std::vector<std::vector<ImpactContact>> findImpacts(const VectorX& before, const VectorX& state) const;

  const Assembly& assembly_;
  EventLog& log_;
  RestingBodies& resting_;
  ImpactBumps& bumps_;
  ConstraintSolver solver_;
  Constraints ties_;  // without taut limits, which contacts may let go
  ConstraintSolver tieSolver_;
  double timeStep_;             // s
  double stepPart_ = INFINITY;  // length of the last step over the method's
  std::vector<Contact> touching_, overlapping_;
  ContactStepping stepping_;
  std::vector<char> strikesInside_;  // by contact, of the next impact; until contacts are solved
  bool stepsOnly_ = false, willStepOnly_ = false;
  std::vector<ContactLoad> loads_;                            // N s, of the last step
  std::vector<std::pair<int, int>> pressed_, pressedBefore_;  // scene bodies in contact: in this step, the one before
};

}  // namespace cradle
