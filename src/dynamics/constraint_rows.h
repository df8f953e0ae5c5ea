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

/// Everything that ties bodies together without giving way.
struct Constraints {
  std::vector<RodConstraint> rods;
  std::vector<BallJointConstraint> ballJoints;
  std::vector<HingeConstraint> hinges;

  bool empty() const { return rods.empty() && ballJoints.empty() && hinges.empty(); }
};

/// One scalar constraint C(positions) = 0 at one instant: J v = dC/dt, and J a = -curvature keeps d^2C/dt^2 = 0.
struct ConstraintRow {
  int bodyA = kFixed, bodyB = kFixed;
  Vec3 linearA, angularA, linearB, angularB;  // J, in parts; world frame
  double value = 0;                           // C
  double curvature = 0;                       // (dJ/dt) v
  double scale = 1;                           // C / scale is the error in m, or rad
  double rounding = 0;                        // m, or rad: an error that arithmetic alone explains
};

/// The rows of all constraints in `state`, in the order rods, ball joints, hinges. `frames` are the bodies' at that
/// state. Units: rods C in m^2 and J in m, joints C in m and J without unit, axes of hinges C without unit. Constraints
/// of bodies marked in `leftOut` have none; it may be empty: none is marked.
void findRows(const Constraints& constraints, const VectorX& state, const std::vector<BodyFrame>& frames,
              std::vector<ConstraintRow>& rows, const std::vector<char>& leftOut = {});

/// J v of a row for the velocities, or accelerations, in `state`.
double rateOf(const ConstraintRow& row, const VectorX& state);

/// Calls tie(bodyA, bodyB) for each constraint; either may be kFixed.
template <class Tie>
void forEachTie(const Constraints& constraints, const Tie& tie) {
  for (const RodConstraint& rod : constraints.rods) tie(rod.anchorA.body, rod.anchorB.body);
  for (const BallJointConstraint& joint : constraints.ballJoints) tie(joint.anchorA.body, joint.anchorB.body);
  for (const HingeConstraint& hinge : constraints.hinges) tie(hinge.anchorA.body, hinge.anchorB.body);
}

}  // namespace cradle
