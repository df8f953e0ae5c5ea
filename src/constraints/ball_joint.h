#pragma once

#include "constraints/constraint_block.h"

namespace cradle {

/// Two points that coincide: C = position of anchor A - position of anchor B = 0, in m; J without unit, so that the
/// multipliers are the force on A (N, world).
struct BallJointConstraint {
  static constexpr int kRows = 3;
};

void putRows(const BallJointConstraint& joint, const ConstraintEnds& ends, ConstraintBlock& block);

}  // namespace cradle
