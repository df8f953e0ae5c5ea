#pragma once

#include "constraints/constraint_block.h"

namespace cradle {

/// Two bodies that move as one: the rows of a ball joint, and those of putSameOrientation.
struct WeldConstraint {
  static constexpr int kRows = 6;
  Mat3 aFromB = Mat3::Identity();  // orientation of body B, or the world, as A, or the world, sees it
};

void putRows(const WeldConstraint& weld, const ConstraintEnds& ends, ConstraintBlock& block);

}  // namespace cradle
