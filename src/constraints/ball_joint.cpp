#include "constraints/ball_joint.h"

namespace cradle {

void appendRows(const BallJointConstraint&, const ConstraintEnds& ends, std::vector<ConstraintRow>& rows) {
  const Vec3 error = ends.a.position - ends.b.position, velocityProduct = centripetalAcceleration(ends);
  const double size = ends.a.position.norm() + ends.a.arm.norm() + ends.b.arm.norm();
  for (int i = 0; i < 3; ++i) {
    const Vec3 direction = Vec3::Unit(i);
    rows.push_back({ends.bodyA, ends.bodyB, direction, ends.a.arm.cross(direction), -direction,
                    -ends.b.arm.cross(direction), error[i], velocityProduct[i], 1, kRowRounding * size});
  }
}

}  // namespace cradle
