#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "impact/pairwise.h"
#include "simulate/moving_island.h"
#include "simulate/plan/islands.h"
#include "simulate/steps/contact_stepping.h"

namespace cradle {

/// What happens where bodies touch at the end of a step: impacts rebound, lasting contacts hold, overlaps are taken
/// out, and what lies still is put to rest.
class ContactStage {
 public:
  /// Keeps a reference to `island`. `timeStep` (s) is the method's.
  ContactStage(MovingIsland& island, double timeStep);

  /// `before` is the state at the step's start: lasting contacts did their work since then.
  void resolve(double time, const VectorX& before, VectorX& state);

  /// What touched at the last call of resolve, if something of it moved.
  const std::vector<Contact>& touching() const { return touching_; }

  /// Many contacts last or chatter: the next step is to end without a search for impacts, by resolveStep.
  bool isCrowded() const { return isCrowded_; }
  void setCrowded() { isCrowded_ = true; }

  /// What happens over a whole step of free motion from `before` to `state`, as one cone problem.
  void resolveStep(double time, const VectorX& before, VectorX& state);

  /// Nearer than this (m) is touching.
  double touchTolerance() const { return touchTolerance_; }

  /// Farther apart (m) nothing is looked at.
  double margin() const { return std::max(touchTolerance_, resting_.supportMargin()); }

 private:
  void findTouching(const VectorX& state, double margin);
  void findWithinReach(const VectorX& before, const VectorX& state, double length);
  std::vector<int> touchingBodies() const;
  void wakeTouched(double time, const VectorX& state);
  void resolveImpacts(double time, const VectorX& before, VectorX& state);
  Islands findStruckTogether() const;
  std::vector<std::vector<ImpactContact>> findImpacts(const VectorX& before, const VectorX& state) const;
  void holdLasting(const VectorX& before, VectorX& state);
  static void dissipate(const Contact& contact, const Vec3& impulse, const VectorX& before, VectorX& state);

  const Assembly& assembly_;
  EventLog& log_;
  RestingBodies& resting_;
  ConstraintSolver solver_;
  double timeStep_, touchTolerance_, leastImpactSpeed_;
  double lastTime_ = -INFINITY;  // s, of the last call of resolve
  double stepPart_ = INFINITY;   // time since then, in steps
  std::vector<Contact> touching_;
  ContactStepping stepping_;
  bool isCrowded_ = false;
};

}  // namespace cradle
