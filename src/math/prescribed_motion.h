#pragma once

#include <variant>

#include "math/key_frame_path.h"

namespace cradle {

/// Constant velocities from a pose at time 0 on.
struct SteadyMotion {
  RigidTransform start;                 // worldFromBody at time 0
  Vec3 velocity = Vec3::Zero();         // m/s, world, of the frame's origin
  Vec3 angularVelocity = Vec3::Zero();  // rad/s, world
};

/// x = x0 + amplitude sin(2 pi frequency t + phase) along a direction.
struct OscillatingMotion {
  RigidTransform middle;           // worldFromBody at x0
  Vec3 direction = Vec3::UnitY();  // unit, world
  double amplitude = 0;            // m
  double frequency = 1;            // 1/s
  double phase = 0;                // rad
};

/// How a body moves that nothing hinders: known for all times.
using PrescribedMotion = std::variant<SteadyMotion, OscillatingMotion, KeyFramePath>;

PoseMotion motionAt(const PrescribedMotion& motion, double time);

/// The first instant (s) after `time` at which a derivative jumps; infinite if there is none.
double nextJump(const PrescribedMotion& motion, double time);

/// s: in which the motion at `time` comes to its like: a period, a turn, or the way to the next key frame; infinite for
/// a straight way at constant speed, and while it waits.
double timeScale(const PrescribedMotion& motion, double time);

/// Whether the pose stays as it is from `time` to the next jump.
bool isStill(const PrescribedMotion& motion, double time);

/// A ball that the frame's origin stays in from time 0 to `duration` (s).
struct MotionBall {
  Vec3 center;    // m, world
  double radius;  // m
};
MotionBall ballOf(const PrescribedMotion& motion, double duration);

/// Moves all poses by that much (m, world).
void shift(PrescribedMotion& motion, const Vec3& by);

}  // namespace cradle
