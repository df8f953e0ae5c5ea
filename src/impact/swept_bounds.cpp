#include "impact/swept_bounds.h"

#include <algorithm>

namespace cradle {
namespace {

// Of its size: distance that a body may be beside its swept bounds. Less renews bounds more often, more keeps pairs
// that never meet.
constexpr double kAsideRatio = 0.05;
// Bodies that a thread takes at once: few enough to balance threads, many enough that they seldom wait for each other.
constexpr std::size_t kRenewedBodies = 512;

}  // namespace

/// Whether a body's box is where it was predicted, and will be until the next detection pass, but for `aside`.
bool SweptBounds::isKept(const Course& course, const MovingPose& pose, const SoftStepStart& look) {
  const Vec3 beside = (pose.boxCenter - course.end + look.timeLeft * course.velocity).cwiseAbs();
  const double faster =
      (pose.linearVelocity - course.velocity).lpNorm<1>() + std::max(0.0, pose.spinSpeed - course.spinSpeed);
  return (beside + pose.boxHalf - course.half).maxCoeff() <= course.aside && faster * look.timeStep <= course.aside;
}

void SweptBounds::renew(const SoftStepStart& look, WorkerThreads& threads) {
  const bool areNew = courses_.empty();
  courses_.resize(look.poses.size());
  isRenewed_.assign(look.poses.size(), 0);
  threads.share(courses_.size(), kRenewedBodies, [&](int, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const MovingPose& pose = look.poses[i];
      if (!areNew && isKept(courses_[i], pose, look)) continue;
      const Vec3 way = look.timeLeft * pose.linearVelocity;
      courses_[i] = {pose.boxCenter + way, pose.boxHalf, pose.linearVelocity, pose.spinSpeed,
                     kAsideRatio * pose.radius};
      isRenewed_[i] = 1;
    }
  });
}

bool SweptBounds::mayMeet(int bodyA, int bodyB, const SoftStepStart& look) const {
  const Course &a = courses_[static_cast<std::size_t>(bodyA)], &b = courses_[static_cast<std::size_t>(bodyB)];
  const Vec3 velocity = b.velocity - a.velocity;
  const double speed = velocity.lpNorm<1>() + a.spinSpeed + b.spinSpeed;
  const double reach = look.margin + look.timeStep * speed + 2 * (a.aside + b.aside);
  const Vec3 end = b.end - a.end, now = end - look.timeLeft * velocity;
  // Along an axis the way from now to the end may pass zero.
  const Vec3 nearest = (now.cwiseMin(end)).cwiseMax(-(now.cwiseMax(end)));
  return (nearest - a.half - b.half).maxCoeff() < reach;
}

}  // namespace cradle
