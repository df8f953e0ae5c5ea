#include "constraints/joint_motor.h"

namespace cradle {

ConstraintRow rowOf(const JointMotor& motor, const VectorX& state, const std::vector<BodyFrame>& frames) {
  ConstraintBlock block;
  findRows(motor.joint, state, frames, block);
  return rowOf(block, 0);
}

}  // namespace cradle
