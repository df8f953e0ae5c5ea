#include "constraints/ball_joint.h"

#include "math/rotation.h"

namespace cradle {

void putRows(const BallJointConstraint&, const ConstraintEnds& ends, ConstraintBlock& block) {
  const Vec3 error = ends.a.position - ends.b.position, velocityProduct = ends.centripetalAcceleration();
  const double size = (ends.a.position.cwiseAbs() + ends.a.arm.cwiseAbs() + ends.b.arm.cwiseAbs()).sum();
  block.isPoint = true;
  block.linear.topRows<3>() = Mat3::Identity();
  block.angularA.topRows<3>() = skew(-ends.a.arm), block.angularB.topRows<3>() = skew(ends.b.arm);
  for (std::size_t i = 0; i < 3; ++i) {
    block.value[i] = error[static_cast<Eigen::Index>(i)];
    block.velocityProduct[i] = velocityProduct[static_cast<Eigen::Index>(i)];
    block.rounding[i] = kRowRounding * size;
  }
}

}  // namespace cradle
