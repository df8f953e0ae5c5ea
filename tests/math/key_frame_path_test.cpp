#include "math/key_frame_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "math/key_frames.h"

namespace cradle {
namespace {

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

/// At a knot between pieces with the mean velocities u and w, of lengths h and k, the parabola has (k u + h w) / (h +
/// k) and 2 (w - u) / (h + k), as long as these are no more than 2 and 4 / max(h, k) times the slower mean velocity.
TEST(KeyFramePath, HasTheDerivativesOfAParabolaUpToThoseOfItsSlowerPiece) {
  const auto atTheMiddle = [](double first, double second) {  // 1 m along (3, 4, 0) / 5 and again, in these times
    const Vec3 way(0.6, 0.8, 0);
    const KeyFramePath path({{2, poseAt({0, 0, 0})}, {2 + first, poseAt(way)}, {2 + first + second, poseAt(2 * way)}},
                            false);
    const PoseMotion motion = path.at(2 + first);
    EXPECT_LT(motion.velocity.cross(way).norm() + motion.acceleration.cross(way).norm(), 1e-13);
    return std::pair(motion.velocity.dot(way), motion.acceleration.dot(way));
  };
  constexpr double kRounding = 1e-13;  // of a few terms of some ten m/s and m/s^2 each
  const auto [even, evenly] = atTheMiddle(1, 1.25);
  EXPECT_NEAR(even, (1.25 * 1 + 1 * 0.8) / 2.25, kRounding);
  EXPECT_NEAR(evenly, 2 * (0.8 - 1) / 2.25, kRounding);
  const auto [slow, slowly] = atTheMiddle(0.25, 5);
  EXPECT_NEAR(slow, 2 * 0.2, kRounding);
  EXPECT_NEAR(slowly, -4 * 0.2 / 5, kRounding);
  const auto [quick, quickly] = atTheMiddle(5, 0.25);
  EXPECT_NEAR(quick, 2 * 0.2, kRounding);
  EXPECT_NEAR(quickly, 4 * 0.2 / 5, kRounding);
}

/// The six points of each piece are those of its Bezier curve: de Casteljau's construction from them, p <- p + s (next
/// - p) again and again, is the position.
TEST(KeyFramePath, HasTheControlPointsOfItsPiecesAsItsHull) {
  const double times[] = {0.5, 1.1, 1.9, 2.6};
  for (const bool repeats : {false, true}) {
    const std::vector<Vec3> hull = wave(repeats).hull();
    ASSERT_EQ(hull.size(), 18u);
    for (std::size_t piece = 0; piece < 3; ++piece)
      for (const double part : {0.0, 0.2, 0.5, 0.9}) {
        std::vector<Vec3> points(hull.begin() + 6 * static_cast<int>(piece),
                                 hull.begin() + 6 * static_cast<int>(piece) + 6);
        for (std::size_t left = 5; left > 0; --left)
          for (std::size_t i = 0; i < left; ++i) points[i] += part * (points[i + 1] - points[i]);
        const double time = times[piece] + part * (times[piece + 1] - times[piece]);
        // Coordinates below 3 m, of polynomials whose terms are some ten m.
        EXPECT_LT((points[0] - wave(repeats).at(time).pose.translation).norm(), 1e-13) << piece << " " << part;
      }
  }
}

}  // namespace
}  // namespace cradle
