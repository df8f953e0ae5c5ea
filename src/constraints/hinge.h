#pragma once

#include <array>

#include "constraints/constraint_block.h"

namespace cradle {

/// A ball joint that turns about one axis only: to its rows come C = axis . across = 0, without unit, for two
/// directions across the axis. With a zero in place of one of them the axis stays across the other alone.
struct HingeConstraint {
  static constexpr int kRows = 5;
  Vec3 axisA = Vec3::UnitZ();     // unit, in body A's frame, or the world
  std::array<Vec3, 2> acrossB{};  // unit, orthogonal to the axis and to each other; in body B's frame, or the world
};

void putRows(const HingeConstraint& hinge, const ConstraintEnds& ends, ConstraintBlock& block);

}  // namespace cradle
