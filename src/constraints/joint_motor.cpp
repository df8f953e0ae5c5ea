#include "constraints/joint_motor.h"

namespace cradle {

ConstraintBlock rowOf(const JointMotor& motor, const VectorX& state, const std::vector<BodyFrame>& frames) {
  ConstraintBlock block;
  findRows(motor.joint, state, frames, block);
  return block;
}

}  // namespace cradle
