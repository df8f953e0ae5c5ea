#include "math/prescribed_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "math/elementary.h"
#include "math/rotation.h"

namespace cradle {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;  // clang 14 needs it

PoseMotion steadyAt(const SteadyMotion& motion, double time) {
  const double angle = time * motion.angularVelocity.norm();
  const Quat turn = angle == 0 ? Quat::Identity() : rotationAbout(motion.angularVelocity, angle);
  PoseMotion now;
  now.pose = {turn * motion.start.rotation, motion.start.translation + time * motion.velocity};
  now.velocity = motion.velocity, now.angularVelocity = motion.angularVelocity;
  return now;
}

PoseMotion oscillationAt(const OscillatingMotion& motion, double time) {
  const double rate = 2 * std::numbers::pi * motion.frequency;
  const auto [sine, cosine] = sinCos(rate * time + motion.phase);
  const Vec3 amplitude = motion.amplitude * motion.direction;
  PoseMotion now;
  now.pose = {motion.middle.rotation, motion.middle.translation + sine * amplitude};
  now.velocity = rate * cosine * amplitude, now.acceleration = -rate * rate * sine * amplitude;
  return now;
}

}  // namespace

PoseMotion motionAt(const PrescribedMotion& motion, double time) {
  return std::visit(Overloaded{[&](const SteadyMotion& steady) { return steadyAt(steady, time); },
                               [&](const OscillatingMotion& oscillation) { return oscillationAt(oscillation, time); },
                               [&](const KeyFramePath& path) { return path.at(time); }},
                    motion);
}

double nextJump(const PrescribedMotion& motion, double time) {
  const auto* path = std::get_if<KeyFramePath>(&motion);
  return path ? path->nextKey(time) : std::numeric_limits<double>::infinity();
}

double timeScale(const PrescribedMotion& motion, double time) {
  if (isStill(motion, time)) return INFINITY;
  return std::visit(
      Overloaded{[](const SteadyMotion& steady) { return 2 * std::numbers::pi / steady.angularVelocity.norm(); },
                 [](const OscillatingMotion& oscillation) { return 1 / std::abs(oscillation.frequency); },
                 [&](const KeyFramePath& path) { return path.lengthAt(time); }},
      motion);
}

bool isStill(const PrescribedMotion& motion, double time) {
  return std::visit(
      Overloaded{
          [](const SteadyMotion& steady) { return steady.velocity.isZero(0) && steady.angularVelocity.isZero(0); },
          [](const OscillatingMotion& oscillation) { return oscillation.amplitude == 0 || oscillation.frequency == 0; },
          [&](const KeyFramePath& path) { return path.isStill(time); }},
      motion);
}

MotionBall ballOf(const PrescribedMotion& motion, double duration) {
  return std::visit(Overloaded{[&](const SteadyMotion& steady) {
                                 const Vec3 half = duration / 2 * steady.velocity;
                                 return MotionBall{steady.start.translation + half, half.norm()};
                               },
                               [](const OscillatingMotion& oscillation) {
                                 return MotionBall{oscillation.middle.translation, std::abs(oscillation.amplitude)};
                               },
                               [](const KeyFramePath& path) {
                                 const std::vector<Vec3> points = path.hull();
                                 Bounds box;
                                 for (const Vec3& point : points) box.extend(point);
                                 MotionBall ball{box.center(), 0};
                                 for (const Vec3& point : points)
                                   ball.radius = std::max(ball.radius, (point - ball.center).norm());
                                 return ball;
                               }},
                    motion);
}

void shift(PrescribedMotion& motion, const Vec3& by) {
  std::visit(Overloaded{[&](SteadyMotion& steady) { steady.start.translation += by; },
                        [&](OscillatingMotion& oscillation) { oscillation.middle.translation += by; },
                        [&](KeyFramePath& path) { path.shift(by); }},
             motion);
}

}  // namespace cradle
