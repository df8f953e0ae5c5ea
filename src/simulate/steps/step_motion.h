#pragma once

#include <algorithm>
#include <vector>

#include "dynamics/rigid_body.h"
#include "simulate/steps/contact_set.h"
#include "simulate/steps/group_problem.h"

namespace cradle {

/// A step of motion without contact, from `before` to `end`, and its middle: where bodies are after half of it if they
/// keep the velocities of its start.
struct FreeStep {
  /// Keeps a reference to `before`.
  FreeStep(const std::vector<RigidBody>& bodies, const VectorX& before, double timeStep, const VectorX& end);

  const VectorX& before;
  double timeStep;  // s
  VectorX end, middle;
  std::vector<BodyFrame> frames;  // of the middle
};

/// Copies poses and velocities of bodies from one state to another.
void copyBodies(const std::vector<int>& bodies, const VectorX& from, VectorX& to);

/// Velocities (m/s) of a group's contacts in a free step, components (t1, t2, n) each. With J the rows of the contacts
/// where they are in the step's middle, and h the time step, a contact's velocity at the step's ends is
/// J v -+ (h/2) (dJ/dt) v.
struct StepMotion {
  VectorX start, free;      // J v of the velocities at the step's start and of those at its free end
  VectorX velocityProduct;  // (h/2) (dJ/dt) v of the velocities at the start
  double timeStep;          // s

  /// Closing speed at the step's start, of the row `normal`.
  double closing(Eigen::Index normal) const { return velocityProduct[normal] - start[normal]; }
  /// What forces add to that in the step, >= 0.
  double pressing(Eigen::Index normal) const {
    return std::max(0.0, -closing(normal) - free[normal] - velocityProduct[normal]);
  }
};

/// The motion of a group. Leaves `problem` with its contacts where they are in the middle of the step.
StepMotion stepMotionOf(const StepGroup& group, const ContactSet& contacts, const FreeStep& step,
                        GroupProblem& problem);

/// The frictional contact problem for velocities at the step's end: a contact that is apart by a gap s may close with
/// s / h, and one that struck rebounds with the fraction `restitutionFraction` of its restitution. Members for which
/// `strikesInside` (by member of `contacts`; empty: none) is set may close freely: they are resolved after the step.
ContactProblem posedStep(const StepGroup& group, const ContactSet& contacts, const StepMotion& motion,
                         const std::vector<char>& strikesInside, double restitutionFraction);

}  // namespace cradle
