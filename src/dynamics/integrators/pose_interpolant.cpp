#include "dynamics/integrators/pose_interpolant.h"

namespace cradle {
namespace {

/// Bound on the slope of a cubic Hermite curve over the unit interval: its three basis slopes are at most 1, 1 and 3/2.
double slopeBound(const Step& step, Eigen::Index at, Eigen::Index size) {
  return step.timeStep * (step.startRate.segment(at, size).norm() + step.endRate.segment(at, size).norm()) +
         1.5 * (step.state.segment(at, size) - step.startState.segment(at, size)).norm();
}

}  // namespace

RigidTransform poseAt(const Step& step, int body, double fraction) {
  if (body == kFixed) return {};
  const double s = fraction, r = 1 - fraction;
  Eigen::Matrix<double, kPoseSize, 1> pose;
  const Eigen::Index at = body * kPoseSize;
  pose =
      (r * r * (1 + 2 * s)) * step.startState.segment<kPoseSize>(at) +
      (s * s * (1 + 2 * r)) * step.state.segment<kPoseSize>(at) +
      (step.timeStep * s * r) * (r * step.startRate.segment<kPoseSize>(at) - s * step.endRate.segment<kPoseSize>(at));
  return {Quat(pose[3], pose[4], pose[5], pose[6]).normalized(), pose.head<3>()};
}

double motionBound(const Step& step, int body, double reach) {
  if (body == kFixed) return 0;
  const Eigen::Index at = body * kPoseSize;
  // An orientation quaternion that moves by a turns the body by 2 a; its interpolant's length stays above one half for
  // any step worth taking.
  const double turn = 2 * slopeBound(step, at + 3, 4) / 0.5;
  return slopeBound(step, at, 3) + turn * reach;
}

}  // namespace cradle
