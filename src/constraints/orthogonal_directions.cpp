#include "constraints/orthogonal_directions.h"

namespace cradle {

void putOrthogonal(const Vec3& directionA, const Vec3& directionB, const ConstraintEnds& ends, std::size_t row,
                   ConstraintBlock& block) {
  const Vec3 a = ends.a.turned(directionA), b = ends.b.turned(directionB);
  const Vec3 &spinA = ends.a.angularVelocity, &spinB = ends.b.angularVelocity;
  const Vec3 lever = a.cross(b);  // dC/dt = lever . (w_A - w_B)
  const Vec3 leverRate = spinA.cross(a).cross(b) + a.cross(spinB.cross(b));
  const Eigen::Index index = static_cast<Eigen::Index>(row);
  block.linear.row(index).setZero();
  block.angularA.row(index) = lever, block.angularB.row(index) = -lever;
  block.value[row] = a.dot(b);
  block.velocityProduct[row] = leverRate.dot(spinA - spinB);
  block.rounding[row] = kRowRounding;
}

void putSameOrientation(const Mat3& aFromB, const ConstraintEnds& ends, std::size_t firstRow, ConstraintBlock& block) {
  for (int i = 0; i < 3; ++i)
    putOrthogonal(aFromB.col(i), Vec3::Unit((i + 1) % 3), ends, firstRow + static_cast<std::size_t>(i), block);
}

}  // namespace cradle
