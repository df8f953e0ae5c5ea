#pragma once

#include <gtest/gtest.h>

#include <numbers>

#include "math/prescribed_motion.h"
#include "math/rotation.h"

// Ways through key frames, and what holds for the rates of any prescribed motion.

namespace cradle {

inline constexpr double kPi = std::numbers::pi;

inline RigidTransform poseAt(const Vec3& position, const Vec3& axis = Vec3::UnitY(), double angle = 0) {
  return {rotationAbout(axis, angle), position};
}

/// A way through four key frames that turns, with the pose of its start at its end.
inline KeyFramePath wave(bool repeats) {
  return KeyFramePath({{0.5, poseAt({0, 0, 0})},
                       {1.1, poseAt({1, 0.4, 0}, {1, 2, 3}, 0.8)},
                       {1.9, poseAt({0.3, 1, -2}, {0, 1, 1}, 2.2)},
                       {2.6, poseAt({0, 0, 0})}},
                      repeats);
}

/// Rates are those of the poses: central differences over 2 h are off by h^2/6 times the third derivative. Here these
/// are below 1e4 (values of order 1 over 0.6 s, to the power of three, and their numbers), which is 2e-8 for h = 1e-5,
/// with rounding of 1e-16 / h = 1e-11.
inline void expectRates(const PrescribedMotion& motion, double time) {
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

}  // namespace cradle
