#include "dynamics/push.h"

#include <gtest/gtest.h>

#include "math/rotation.h"

namespace cradle {
namespace {

VectorX tumblingState() {
  VectorX state = VectorX::Zero(stateSize(2));
  for (const int body : {0, 1}) {
    centerOfMass(state, body) = Vec3(1, body, -2);
    setOrientation(state, body, rotationAbout(Vec3(1, 2, body), 0.7));
    linearVelocity(state, body) = Vec3(0.4, -1 + body, 2), angularVelocity(state, body) = Vec3(1, -2, 0.5 + body);
  }
  return state;
}

// F . (v + w x r), r turned with the body: a few terms below 10 W.
TEST(Push, HasThePowerOfItsForceAtItsPoint) {
  const VectorX state = tumblingState();
  const Vec3 point(0.3, -0.2, 0.5), force(2, 1, -3);
  for (const int body : {0, 1}) {
    const Vec3 arm = rotationAbout(Vec3(1, 2, body), 0.7) * point;
    const Vec3 velocity = Vec3(0.4, -1 + body, 2) + Vec3(1, -2, 0.5 + body).cross(arm);
    EXPECT_NEAR(powerOf({{body, point}, force}, state), force.dot(velocity), 1e-14) << body;
  }
}

TEST(Push, HasThePowerOfItsTorqueWhateverItsPoint) {
  const Vec3 torque(2, 1, -3);
  EXPECT_NEAR(powerOf({{0, Vec3(5, 6, 7)}, Vec3::Zero(), torque}, tumblingState()), 2 - 2 - 3 * 0.5, 1e-15);
  EXPECT_NEAR(powerOf({{1, Vec3(5, 6, 7)}, Vec3::Zero(), torque}, tumblingState()), 2 - 2 - 3 * 1.5, 1e-15);
}

TEST(Push, HasNoPowerOnWhatIsFixed) {
  EXPECT_EQ(powerOf({{kFixed, Vec3(5, 6, 7)}, Vec3(1, 2, 3)}, tumblingState()), 0);
}

}  // namespace
}  // namespace cradle
