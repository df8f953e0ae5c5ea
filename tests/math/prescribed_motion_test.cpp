#include "math/prescribed_motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "math/rotation.h"

namespace cradle {
namespace {

constexpr double kPi = std::numbers::pi;

RigidTransform poseAt(const Vec3& position, const Vec3& axis = Vec3::UnitY(), double angle = 0) {
  return {rotationAbout(axis, angle), position};
}

KeyFramePath wave(bool repeats) {
  return KeyFramePath({{0.5, poseAt({0, 0, 0})},
                       {1.1, poseAt({1, 0.4, 0}, {1, 2, 3}, 0.8)},
                       {1.9, poseAt({0.3, 1, -2}, {0, 1, 1}, 2.2)},
                       {2.6, poseAt({0, 0, 0})}},
                      repeats);
}

/// Rates are those of the poses: central differences over 2 h are off by h^2/6 times the third derivative. Here these
/// are below 1e4 (values of order 1 over 0.6 s, to the power of three, and their numbers), which is 2e-8 for h = 1e-5,
/// with rounding of 1e-16 / h = 1e-11.
void expectRates(const PrescribedMotion& motion, double time) {
  constexpr double kHalf = 1e-5, kTolerance = 1e-6;
  const PoseMotion now = motionAt(motion, time), before = motionAt(motion, time - kHalf),
                   after = motionAt(motion, time + kHalf);
  EXPECT_LT(((after.pose.translation - before.pose.translation) / (2 * kHalf) - now.velocity).norm(), kTolerance);
  EXPECT_LT(((after.velocity - before.velocity) / (2 * kHalf) - now.acceleration).norm(), kTolerance) << time;
  const Quat turn = after.pose.rotation * before.pose.rotation.conjugate();
  const Vec3 spin = 2 * turn.vec() * (turn.w() < 0 ? -1 : 1) / (2 * kHalf);  // sin(a/2) = a/2 to a^3/48
  EXPECT_LT((spin - now.angularVelocity).norm(), kTolerance) << time;
  EXPECT_LT(((after.angularVelocity - before.angularVelocity) / (2 * kHalf) - now.angularAcceleration).norm(),
            kTolerance)
      << time;
}

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

/// Two key frames at rest, without acceleration: 10 s^3 - 15 s^4 + 6 s^5.
TEST(KeyFramePath, TwoKeyFramesAreJoinedByThePolynomialOfDegreeFive) {
  const PrescribedMotion motion = KeyFramePath({{1, poseAt({0, 0, 0})}, {3, poseAt({4, 0, 0})}}, false);
  for (const double s : {0.0, 0.2, 0.5, 0.9, 1.0}) {
    const double x = 4 * s * s * s * (10 - 15 * s + 6 * s * s);
    EXPECT_NEAR(motionAt(motion, 1 + 2 * s).pose.translation.x(), x, 1e-14);
  }
  EXPECT_LT(motionAt(motion, 1).acceleration.norm(), 1e-14);
  EXPECT_LT(motionAt(motion, 3).acceleration.norm(), 1e-13);
}

TEST(KeyFramePath, PassesItsKeyFramesAndRestsBeforeAndBehindThem) {
  const PrescribedMotion motion = wave(false);
  const PoseMotion second = motionAt(motion, 1.1);
  EXPECT_LT((second.pose.translation - Vec3(1, 0.4, 0)).norm(), 1e-14);
  EXPECT_LT(second.pose.rotation.angularDistance(rotationAbout({1, 2, 3}, 0.8)), 1e-7);
  for (const double time : {-1.0, 0.0, 0.5, 2.6, 9.0}) {
    const PoseMotion at = motionAt(motion, time);
    EXPECT_LT(at.pose.translation.norm(), 1e-13) << time;
    EXPECT_LT(at.velocity.norm() + at.acceleration.norm() + at.angularVelocity.norm() + at.angularAcceleration.norm(),
              1e-11)
        << time;
  }
  EXPECT_TRUE(isStill(motion, 0.2));
  EXPECT_FALSE(isStill(motion, 0.5));
  EXPECT_FALSE(isStill(motion, 2.5));
  EXPECT_TRUE(isStill(motion, 2.6));
}

TEST(KeyFramePath, RatesAreThoseOfThePoses) {
  for (const bool repeats : {false, true})
    for (const double time : {0.6, 1.05, 1.15, 1.5, 1.95, 2.2, 2.59}) expectRates(wave(repeats), time);
}

TEST(KeyFramePath, AccelerationsAreContinuousAtKeyFrames) {
  for (const bool repeats : {false, true})
    for (const double key : {0.5, 1.1, 1.9, 2.6}) {
      const PrescribedMotion motion = wave(repeats);
      const PoseMotion before = motionAt(motion, key - 1e-9), after = motionAt(motion, key + 1e-9);
      EXPECT_LT((after.acceleration - before.acceleration).norm(), 1e-5) << key;  // 2e-9 s x 1e3 m/s^3
      EXPECT_LT((after.angularAcceleration - before.angularAcceleration).norm(), 1e-5) << key;
    }
}

TEST(KeyFramePath, StandsStillBetweenEqualKeyFrames) {
  const RigidTransform there = poseAt({1, 2, 0}, {1, 0, 0}, 1);
  const PrescribedMotion motion =
      KeyFramePath({{0, poseAt({0, 0, 0})}, {1, there}, {2, there}, {4, poseAt({0, 3, 0})}}, false);
  for (const double time : {1.0, 1.3, 1.9, 2.0}) {
    const PoseMotion at = motionAt(motion, time);
    EXPECT_LT((at.pose.translation - Vec3(1, 2, 0)).norm(), 1e-15) << time;
    EXPECT_LT(at.velocity.norm() + at.acceleration.norm() + at.angularVelocity.norm(), 1e-14) << time;
  }
  EXPECT_TRUE(isStill(motion, 1));
  EXPECT_FALSE(isStill(motion, 2));
}

/// A circle by twelve key frames: within some thousandths of its radius.
TEST(KeyFramePath, GoesAroundACircle) {
  std::vector<KeyFrame> keys;
  for (int i = 0; i <= 12; ++i) keys.push_back({0.25 * i, poseAt({std::cos(kPi * i / 6), std::sin(kPi * i / 6), 0})});
  const PrescribedMotion motion = KeyFramePath(keys, true);
  for (double time = 0; time < 3; time += 0.01) EXPECT_NEAR(motionAt(motion, time).pose.translation.norm(), 1, 4e-3);
}

/// A slow piece beside a quick one: it does not swing out.
TEST(KeyFramePath, DoesNotSwingOutWhereItSlowsDown) {
  const PrescribedMotion motion = KeyFramePath(
      {{0, poseAt({0, 0, 0})}, {0.1, poseAt({1, 0, 0})}, {10, poseAt({1.5, 0, 0})}, {10.1, poseAt({3, 0, 0})}}, false);
  for (double time = 0.1; time < 10; time += 0.01) {
    EXPECT_GT(motionAt(motion, time).pose.translation.x(), 0.9);
    EXPECT_LT(motionAt(motion, time).pose.translation.x(), 1.6);
  }
}

/// Where the way turns back, or by a right angle, and where the axis of its turning does: it stays between key frames.
TEST(KeyFramePath, GoesNoFartherThanItsKeyFramesAtCorners) {
  const PrescribedMotion motion = KeyFramePath({{0, poseAt({0, 1, 0}, {0, 1, 0}, 0)},
                                                {0.8, poseAt({0, 0, 0}, {0, 1, 0}, 1)},
                                                {1.3, poseAt({0.4, 0, 0}, {0, 1, 0}, 0.5)},
                                                {1.5, poseAt({0.4, 0, 0.3}, {0, 1, 0}, 1)},
                                                {2, poseAt({0.4, 0, -0.2}, {0, 1, 0}, 1)}},
                                               false);
  for (double time = 0; time < 2; time += 0.01) {
    const PoseMotion at = motionAt(motion, time);
    const Vec3& place = at.pose.translation;
    const double angle = 2 * std::atan2(at.pose.rotation.y(), at.pose.rotation.w());
    EXPECT_TRUE(place.x() > -1e-15 && place.x() < 0.4 + 1e-15) << time;
    EXPECT_TRUE(place.y() > -1e-15 && place.y() < 1 + 1e-15) << time;
    EXPECT_TRUE(place.z() > -0.2 - 1e-15 && place.z() < 0.3 + 1e-15) << time;
    EXPECT_TRUE(angle > -1e-15 && angle < 1 + 1e-15) << time;
  }
}

TEST(KeyFramePath, RepeatsWithItsPeriod) {
  const PrescribedMotion motion = wave(true);
  for (const double time : {0.6, 1.3, 2.5}) {
    const PoseMotion first = motionAt(motion, time), later = motionAt(motion, time + 3 * 2.1);
    EXPECT_LT((first.pose.translation - later.pose.translation).norm(), 1e-12);
    EXPECT_LT((first.acceleration - later.acceleration).norm(), 1e-10);
  }
  EXPECT_FALSE(isStill(motion, 0));
  EXPECT_NEAR(nextJump(motion, 2.0), 2.6, 1e-15);
  EXPECT_NEAR(nextJump(motion, 2.6), 1.1 + 2.1, 1e-14);
  EXPECT_NEAR(nextJump(motion, 4.1), 2.6 + 2.1, 1e-14);
}

/// A whole turn by thirds, again and again: the quaternion ends as the negative one. At key frames the angle is known,
/// and by symmetry the rate is the same at all of them.
TEST(KeyFramePath, TurnsOnAfterAWholeTurn) {
  std::vector<KeyFrame> keys;
  for (int i = 0; i <= 3; ++i) keys.push_back({0.5 * i, poseAt({0, 0, 0}, Vec3::UnitY(), 2 * kPi * i / 3)});
  const PrescribedMotion motion = KeyFramePath(keys, true);
  for (const double time : {0.1, 0.9, 1.4, 1.6, 2.9, 3.1}) expectRates(motion, time);
  const Vec3 spin = motionAt(motion, 0).angularVelocity;
  EXPECT_GT(spin.y(), 3);
  for (const double time : {0.5, 1.0, 1.5, 4.5})
    EXPECT_LT((motionAt(motion, time).angularVelocity - spin).norm(), 1e-11);
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

}  // namespace
}  // namespace cradle
