#include "math/prescribed_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/key_frames.h"

namespace cradle {
namespace {

TEST(PrescribedMotion, SteadyMotionGoesStraightAndTurnsAboutOneAxis) {
  const PrescribedMotion motion = SteadyMotion{poseAt({1, 2, 3}), {0.5, 0, 0}, {0, 4, 0}};
  const PoseMotion now = motionAt(motion, 2);
  EXPECT_LT((now.pose.translation - Vec3(2, 2, 3)).norm(), 1e-15);
  EXPECT_LT((now.pose.rotation * Vec3::UnitX() - Vec3(std::cos(8.0), 0, -std::sin(8.0))).norm(), 1e-15);
  EXPECT_FALSE(isStill(motion, 0));
  EXPECT_EQ(nextJump(motion, 0), std::numeric_limits<double>::infinity());
  expectRates(motion, 0.3);
}

TEST(PrescribedMotion, OscillationIsASine) {
  const PrescribedMotion motion = OscillatingMotion{poseAt({0, 1, 0}), Vec3::UnitY(), 0.2, 3, 0.4};
  for (const double time : {0.0, 0.1, 0.77}) {
    const double angle = 2 * kPi * 3 * time + 0.4;
    const PoseMotion now = motionAt(motion, time);
    EXPECT_NEAR(now.pose.translation.y(), 1 + 0.2 * std::sin(angle), 1e-15);
    EXPECT_NEAR(now.velocity.y(), 0.2 * 6 * kPi * std::cos(angle), 1e-14);
    EXPECT_NEAR(now.acceleration.y(), -0.2 * 36 * kPi * kPi * std::sin(angle), 1e-13);
  }
  EXPECT_FALSE(isStill(motion, 0));
  EXPECT_TRUE(isStill(OscillatingMotion{{}, Vec3::UnitY(), 0, 3, 0}, 0));
}

TEST(PrescribedMotion, StaysInItsBall) {
  for (const PrescribedMotion& motion : {PrescribedMotion(wave(false)), PrescribedMotion(wave(true)),
                                         PrescribedMotion(SteadyMotion{{}, {1, 2, 0}, Vec3::Zero()}),
                                         PrescribedMotion(OscillatingMotion{{}, Vec3::UnitX(), -0.3, 2, 1})}) {
    const MotionBall ball = ballOf(motion, 4);
    for (double time = 0; time <= 4; time += 0.01)
      EXPECT_LE((motionAt(motion, time).pose.translation - ball.center).norm(), ball.radius + 1e-12);
  }
}

TEST(PrescribedMotion, ShiftMovesAllPoses) {
  for (PrescribedMotion motion :
       {PrescribedMotion(wave(true)), PrescribedMotion(SteadyMotion{{}, {1, 2, 0}, Vec3::Zero()}),
        PrescribedMotion(OscillatingMotion{{}, Vec3::UnitX(), 0.3, 2, 1})}) {
    const Vec3 before = motionAt(motion, 1.7).pose.translation;
    shift(motion, {1, 2, 3});
    EXPECT_LT((motionAt(motion, 1.7).pose.translation - before - Vec3(1, 2, 3)).norm(), 1e-14);
  }
}

TEST(PrescribedMotion, ComesToItsLikeInAPeriodATurnOrAWay) {
  EXPECT_EQ(timeScale(OscillatingMotion{{}, Vec3::UnitY(), 0.1, -4, 0}, 7), 0.25);
  EXPECT_NEAR(timeScale(SteadyMotion{{}, Vec3::UnitX(), Vec3(0, 0, -2 * kPi)}, 7), 1, 1e-15);
  EXPECT_EQ(timeScale(SteadyMotion{{}, Vec3::UnitX(), Vec3::Zero()}, 7), INFINITY);
  EXPECT_NEAR(timeScale(wave(false), 0.7), 0.6, 1e-15);  // from 0.5 to 1.1 s
  EXPECT_NEAR(timeScale(wave(false), 1.1), 0.8, 1e-15);
  EXPECT_EQ(timeScale(wave(false), 0.4), INFINITY);
  EXPECT_EQ(timeScale(wave(false), 2.6), INFINITY);
  EXPECT_NEAR(timeScale(wave(true), 2.7), 0.6, 1e-15);
}

}  // namespace
}  // namespace cradle
