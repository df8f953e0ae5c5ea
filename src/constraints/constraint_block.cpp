#include "constraints/constraint_block.h"

namespace cradle {

ConstraintRow rowOf(const ConstraintBlock& block, int row) {
  const Vec3 linear = block.linear.row(row);
  const std::size_t i = static_cast<std::size_t>(row);
  return {block.bodyA,    block.bodyB,
          linear,         block.turnsA ? Vec3(block.angularA.row(row)) : Vec3::Zero(),
          -linear,        block.turnsB ? Vec3(block.angularB.row(row)) : Vec3::Zero(),
          block.value[i], block.velocityProduct[i],
          block.scale,    block.rounding[i]};
}

}  // namespace cradle
