#pragma once

#include "constraints/constraint_block.h"

namespace cradle {

/// A massless rigid rod between two points: C = (d.d - length^2) / 2 = 0 with d from anchor B to anchor A. C in m^2, J
/// in m: a multiplier times the length is the force (N) that pushes the ends apart.
struct RodConstraint {
  static constexpr int kRows = 1;
  double length = 0;  // m, > 0
};

void putRows(const RodConstraint& rod, const ConstraintEnds& ends, ConstraintBlock& block);

}  // namespace cradle
