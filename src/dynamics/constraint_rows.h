#pragma once

#include <vector>

#include "dynamics/rigid_body.h"

namespace cradle {

/// A massless rigid rod between two points: C = (d.d - length^2) / 2 = 0 with d from anchor B to anchor A.
struct RodConstraint {
  Attachment anchorA, anchorB;
  double length = 0;  // m, > 0
};

/// One scalar constraint C(positions) = 0 at one instant: J v = dC/dt, and J a = -curvature keeps d^2C/dt^2 = 0.
struct ConstraintRow {
  int bodyA = kFixed, bodyB = kFixed;
  Vec3 linearA, angularA, linearB, angularB;  // J, in parts; world frame
  double value = 0;                           // C
  double curvature = 0;                       // (dJ/dt) v
};

/// Units: C in m^2, J in m and m^2 (per rad).
ConstraintRow rowOf(const RodConstraint& rod, const VectorX& state);

/// J v of a row for the velocities in `state`.
double rateOf(const ConstraintRow& row, const VectorX& state);

}  // namespace cradle
