#pragma once

#include <vector>

#include "dynamics/rigid_body.h"

namespace cradle {

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

/// Of the lengths that enter a row: a few units in their last place.
constexpr double kRowRounding = 1e-15;

/// J v of a row for the velocities, or accelerations, in `state`.
double rateOf(const ConstraintRow& row, const VectorX& state);

}  // namespace cradle
