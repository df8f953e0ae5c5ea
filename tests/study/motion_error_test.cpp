#include "study/motion_error.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

BodyState stateAt(const Vec3& position, const Quat& orientation) {
  BodyState state;
  state.position = position;
  state.orientation = orientation;
  return state;
}

TEST(MotionError, IsRelativeToOnePlusTheReference) {
  const std::vector<BodyState> reference = {stateAt({3, 0, 0}, Quat::Identity())};
  EXPECT_DOUBLE_EQ(motionError({stateAt({3.5, 0, 0}, Quat::Identity())}, reference), 0.5 / 4);
  EXPECT_DOUBLE_EQ(motionError({stateAt({3.5, 0.25, 0}, Quat::Identity())}, reference), 0.25);
}

TEST(MotionError, TakesTheWorstBody) {
  const std::vector<BodyState> reference(2);
  std::vector<BodyState> states(2);
  states[1].position.z() = -0.5;
  EXPECT_DOUBLE_EQ(motionError(states, reference), 0.5);
}

TEST(MotionError, CountsTurnsButNotTheSignOfAQuaternion) {
  const Quat turned(Eigen::AngleAxisd(0.2, Vec3::UnitX()));
  const std::vector<BodyState> reference = {stateAt(Vec3::Zero(), Quat::Identity())};
  EXPECT_DOUBLE_EQ(motionError({stateAt(Vec3::Zero(), turned)}, reference), std::sin(0.1));
  EXPECT_EQ(motionError({stateAt(Vec3::Zero(), Quat(-1, 0, 0, 0))}, reference), 0);
}

TEST(MotionError, IsBlindForVelocities) {
  BodyState fast;
  fast.linearVelocity.x() = fast.angularVelocity.y() = 7;
  EXPECT_EQ(motionError({fast}, {BodyState()}), 0);
}

TEST(MotionError, OfAStateThatIsNoNumberIsNone) {
  EXPECT_TRUE(std::isnan(motionError({stateAt({std::nan(""), 0, 0}, Quat::Identity())}, {BodyState()})));
}

}  // namespace
}  // namespace cradle
