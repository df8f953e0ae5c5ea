#pragma once

#include <array>

#include "constraints/constraint_block.h"

namespace cradle {

/// A body A that moves along an axis of B and does not turn against it (a prismatic joint): C = u . d = 0, in m, with d
/// from anchor B to anchor A, for two directions u across the axis; and the rows of putSameOrientation. The axis stays
/// where B has it, so that the multipliers of the first two rows are forces on A (N) in its anchor, and on B in that
/// same point.
struct SliderConstraint {
  static constexpr int kRows = 5;
  std::array<Vec3, 2> acrossB{};   // unit, orthogonal to the axis and to each other; in body B's frame, or the world
  Mat3 aFromB = Mat3::Identity();  // orientation of body B, or the world, as A, or the world, sees it

  Vec3 axisB() const { return acrossB[0].cross(acrossB[1]); }  // unit, in body B's frame, or the world
};

void putRows(const SliderConstraint& slider, const ConstraintEnds& ends, ConstraintBlock& block);

}  // namespace cradle
