#include "constraints/hinge.h"

#include "constraints/ball_joint.h"

namespace cradle {

void putRows(const HingeConstraint& hinge, const ConstraintEnds& ends, ConstraintBlock& block) {
  putRows(BallJointConstraint(), ends, block);
  block.turnsA = ends.a.rotation, block.turnsB = ends.b.rotation;  // wherever the anchors are
  const Vec3 axis = ends.a.turned(hinge.axisA);
  const Vec3 &spinA = ends.a.angularVelocity, &spinB = ends.b.angularVelocity;
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3 across = ends.b.turned(hinge.acrossB[i]);
    const Vec3 lever = axis.cross(across);  // dC/dt = lever . (w_A - w_B)
    const Vec3 leverRate = spinA.cross(axis).cross(across) + axis.cross(spinB.cross(across));
    const std::size_t row = 3 + i;
    const Eigen::Index column = static_cast<Eigen::Index>(row);
    block.linear.row(column).setZero();
    block.angularA.row(column) = lever, block.angularB.row(column) = -lever;
    block.value[row] = axis.dot(across);
    block.velocityProduct[row] = leverRate.dot(spinA - spinB);
    block.rounding[row] = kRowRounding;
  }
}

}  // namespace cradle
