#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "impact/pairwise.h"
#include "simulate/island_state.h"
#include "simulate/plan/disjoint_sets.h"
#include "simulate/rope_events.h"
#include "simulate/steps/contact_stepping.h"

namespace cradle {

/// What happens where bodies touch: active contacts hold over steps, impacts rebound at their ends, and what lies
/// still is put to rest.
class StepContacts {
 public:
  /// Keeps a reference to `island`. `timeStep` (s) is the method's.
  StepContacts(IslandState& island, double timeStep);

  /// Finds what may touch within a step of free motion of `length` (s) from `before` to `state`.
  void begin(double time, const VectorX& before, const VectorX& state, double length);

  /// Near pairs but those that are held over the step.
  std::vector<ColliderPair> pairsWithoutContact() const;

  /// The fraction of that step at which the next impact inside it comes, whose contacts are then resolved after the
  /// step; infinite if there is none.
  double nextImpact(const VectorX& before, const VectorX& state, double length);

  /// What contact makes of a step that has begun, now of this `length`: one frictional contact problem, with `ropes`
  /// that may be stretched in it.
  void solveContacts(const VectorX& before, double length, const RopeEvents& ropes, VectorX& state);

  /// What friction took (J) in the step that was held last, and would have at the velocities of its start.
  ContactStepping::FrictionWork frictionWork() const { return stepping_.frictionWork(); }

  /// How far (m or rad) that left constraints from where they should be.
  double constraintError() const { return stepping_.constraintError(); }

  /// Records what hit within the step that was held last, if one was, and puts to rest what lies still at its end.
  void recordAndLetSleep(double time, VectorX& state);

  /// The impacts of this instant. `before` is the state at the step's start.
  void strike(double time, const VectorX& before, VectorX& state);

  /// What may have touched in the last step, or touched at its end, if something of it moved.
  const std::vector<Contact>& touching() const { return touching_; }

  /// Whether something struck within the last step, and not at its end.
  bool hasImpact() const;

  /// Many contacts last or chatter: impacts are no longer searched for.
  bool usesTimeSteppingOnly() const { return stepsOnly_; }
  void useTimeSteppingOnly() { willStepOnly_ = true; }

  /// Nearer than this (m) is touching.
  double touchTolerance() const { return touchTolerance_; }

  /// Farther apart (m) nothing is looked at.
  double margin() const { return std::max(touchTolerance_, resting_.supportMargin()); }

 private:
  void findTouching(const VectorX& state, double margin) { findTouching(state, margin, touching_); }
  void findTouching(const VectorX& state, double margin, std::vector<Contact>& touching);
  void loosenShortMomentArms(const VectorX& state, std::vector<Contact>& contacts);
  void correctPenetrations(const RopeEvents& ropes, VectorX& state);
  void findWithinReach(const VectorX& before, const VectorX& state, double length);
  void findStepContacts(const VectorX& before, const VectorX& state, double length);
  void findSimultaneous(const VectorX& state);
  double lightest(const Contact& contact) const;
  void letSleep(double time, const std::vector<Contact>& contacts, VectorX& state);
  void recordFaults(double time);
  void wakeTouched(double time, const VectorX& state);
  void resolveImpacts(double time, const VectorX& before, VectorX& state);
  DisjointSets findImpactIslands() const;
  std::vector<std::vector<ImpactContact>> findImpacts(const VectorX& before, const VectorX& state) const;

  const Assembly& assembly_;
  EventLog& log_;
  RestingBodies& resting_;
  ConstraintSolver solver_;
  double timeStep_, touchTolerance_;             // s, m
  double leastClosingSpeed_, leastImpactSpeed_;  // m/s
  double stepPart_ = INFINITY;                   // of a step, that the last one took
  std::vector<Contact> touching_, overlapping_;
  ContactStepping stepping_;
  std::vector<char> strikesInside_;  // by contact, of the next impact; until contacts are solved
  bool stepsOnly_ = false, willStepOnly_ = false;
};

}  // namespace cradle
