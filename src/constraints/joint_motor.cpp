#include "constraints/joint_motor.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr double kSettled = 1e-11;          // s: what all of the force mends sooner has no time
constexpr double kSettledRounding = 1e-12;  // of 1 m/s or rad/s, or of the target if that is more

}  // namespace

double settledSpeed(const JointMotor& motor, double mobility) {
  return kSettled * motor.maxForce * std::abs(mobility) +
         kSettledRounding * std::max(1.0, std::abs(motor.targetVelocity));
}

ConstraintBlock rowOf(const JointMotor& motor, const VectorX& state, const std::vector<BodyFrame>& frames) {
  ConstraintBlock block;
  findRows(motor.joint, state, frames, block);
  return block;
}

}  // namespace cradle
