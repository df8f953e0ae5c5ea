#pragma once

#include "constraints/constraint_row.h"

namespace cradle {

/// Two points that coincide: C = position of anchor A - position of anchor B = 0, in m; J without unit, so that the
/// multipliers are the force on A (N, world).
struct BallJointConstraint {
  static constexpr int kRows = 3;
};

void appendRows(const BallJointConstraint& joint, const ConstraintEnds& ends, std::vector<ConstraintRow>& rows);

}  // namespace cradle
