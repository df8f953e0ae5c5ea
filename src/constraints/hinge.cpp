#include "constraints/hinge.h"

#include "constraints/ball_joint.h"

namespace cradle {

void appendRows(const HingeConstraint& hinge, const ConstraintEnds& ends, std::vector<ConstraintRow>& rows) {
  appendRows(BallJointConstraint(), ends, rows);
  const Vec3 axis = ends.rotationA ? Vec3(*ends.rotationA * hinge.axisA) : hinge.axisA;
  const Vec3 &spinA = ends.angularVelocityA, &spinB = ends.angularVelocityB;
  for (const Vec3& acrossB : hinge.acrossB) {
    const Vec3 across = ends.rotationB ? Vec3(*ends.rotationB * acrossB) : acrossB;
    const Vec3 lever = axis.cross(across);  // dC/dt = lever . (w_A - w_B)
    const Vec3 leverRate = spinA.cross(axis).cross(across) + axis.cross(spinB.cross(across));
    rows.push_back({ends.bodyA, ends.bodyB, Vec3::Zero(), lever, Vec3::Zero(), -lever, axis.dot(across),
                    leverRate.dot(spinA - spinB), 1, kRowRounding});
  }
}

}  // namespace cradle
