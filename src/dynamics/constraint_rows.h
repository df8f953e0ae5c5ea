#pragma once

#include <array>
#include <vector>

#include "dynamics/rigid_body.h"

namespace cradle {

/// A massless rigid rod between two points: C = (d.d - length^2) / 2 = 0 with d from anchor B to anchor A. One row.
struct RodConstraint {
  Attachment anchorA, anchorB;
  double length = 0;  // m, > 0
};

/// Two points that coincide: C = position of anchor A - position of anchor B = 0. Three rows.
struct BallJointConstraint {
  Attachment anchorA, anchorB;
};

/// A ball joint that turns about one axis only: C = axis . across = 0 for two directions across it. Five rows. With a
/// zero in place of one of them the axis stays across the other alone.
struct HingeConstraint {
  Attachment anchorA, anchorB;
  Vec3 axisA = Vec3::UnitZ();     // unit, in body A's frame
  std::array<Vec3, 2> acrossB{};  // unit, orthogonal to the axis and to each other; in body B's frame, or the world
};

/// The bilateral constraints of bodies: rods and joints.
struct Constraints {
  std::vector<RodConstraint> rods;
  std::vector<BallJointConstraint> ballJoints;
  std::vector<HingeConstraint> hinges;

  bool empty() const { return rods.empty() && ballJoints.empty() && hinges.empty(); }
};

/// One row of a bilateral constraint C(positions) = 0 at one instant, with the Jacobian J: dC/dt = J v, and
/// d^2C/dt^2 = J a + (dJ/dt) v, which is 0 for J a = -velocityProduct. (R. Featherstone, "Rigid Body Dynamics
/// Algorithms", 2008, 3.4)
struct ConstraintRow {
  int bodyA = kFixed, bodyB = kFixed;
  Vec3 linearA, angularA, linearB, angularB;  // the Jacobian J, in parts; world frame
  double value = 0;                           // C, the constraint error
  double velocityProduct = 0;                 // (dJ/dt) v
  double scale = 1;                           // C / scale is the error in m, or rad
  double rounding = 0;                        // m, or rad: an error that arithmetic alone explains
};

/// The rows of all constraints in `state`, in the order rods, ball joints, hinges. `frames` are the bodies' at that
/// state. Units: rods C in m^2 and J in m, joints C in m and J without unit, axes of hinges C without unit. Constraints
/// of bodies marked in `excluded` have none; it may be empty: none is marked.
void findRows(const Constraints& constraints, const VectorX& state, const std::vector<BodyFrame>& frames,
              std::vector<ConstraintRow>& rows, const std::vector<char>& excluded = {});

/// J v of a row for the velocities, or accelerations, in `state`.
double rateOf(const ConstraintRow& row, const VectorX& state);

/// Calls visit(bodyA, bodyB) for each constraint; either may be kFixed.
template <class Visit>
void forEachConstraint(const Constraints& constraints, const Visit& visit) {
  for (const RodConstraint& rod : constraints.rods) visit(rod.anchorA.body, rod.anchorB.body);
  for (const BallJointConstraint& joint : constraints.ballJoints) visit(joint.anchorA.body, joint.anchorB.body);
  for (const HingeConstraint& hinge : constraints.hinges) visit(hinge.anchorA.body, hinge.anchorB.body);
}

}  // namespace cradle
