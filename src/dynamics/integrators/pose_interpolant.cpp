#include "dynamics/integrators/pose_interpolant.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cradle {
namespace {

using Pose = Eigen::Matrix<double, kPoseSize, 1>;

/// Largest slopes over the unit interval of what multiplies the corrections: s^2 r^2, s^3 r^2, s^3 r^3, s^4 r^3;
/// rounded up.
constexpr std::array<double, 4> kCorrectionSlopes = {0.19246, 0.13558, 0.05367, 0.03359};

constexpr double kShortestQuaternion = 0.5;  // on the interpolant of any step worth taking

/// Components of the interpolant from `at` on. The quaternion is not of unit length.
template <int kSize>
Eigen::Matrix<double, kSize, 1> componentsAt(const Step& step, Eigen::Index at, double fraction) {
  const double s = fraction, r = 1 - fraction;
  Eigen::Matrix<double, kSize, 1> part =
      (r * r * (1 + 2 * s)) * step.startState.segment<kSize>(at) +
      (s * s * (1 + 2 * r)) * step.state.segment<kSize>(at) +
      (step.timeStep * s * r) * (r * step.startRate.segment<kSize>(at) - s * step.endRate.segment<kSize>(at));
  if (step.interpolant == InterpolantKind::degreeSeven) {
    const auto c = [&](std::size_t i) { return step.corrections[i].segment<kSize>(at); };
    part += (s * s * r * r) * (c(0) + s * (c(1) + r * (c(2) + s * c(3))));
  }
  return part;
}

/// Bound on the slope of the interpolant over the unit interval. That of the cubic is h (r f0 + s f1) + 6 s r (y1 - y0
/// - h (f0 + f1) / 2), with 6 s r <= 3/2; the curve of degree 7 adds its corrections.
template <int kSize>
double slopeBound(const Step& step, Eigen::Index at) {
  const Eigen::Matrix<double, kSize, 1> start = step.timeStep * step.startRate.segment<kSize>(at),
                                        end = step.timeStep * step.endRate.segment<kSize>(at);
  const auto bend = step.state.segment<kSize>(at) - step.startState.segment<kSize>(at) - 0.5 * (start + end);
  double bound = std::max(start.norm(), end.norm()) + 1.5 * bend.norm();
  if (step.interpolant == InterpolantKind::degreeSeven)
    for (std::size_t i = 0; i < kCorrectionSlopes.size(); ++i)
      bound += kCorrectionSlopes[i] * step.corrections[i].segment<kSize>(at).norm();
  return bound;
}

/// Lower bound on the length of an interpolated quaternion: from the nearest of so many samples it falls by at most
/// 1/8.
double leastLength(const Step& step, Eigen::Index at, double slope) {
  constexpr double kMostSamples = 32;
  const double samples = 1 + std::floor(std::min(kMostSamples, 4 * slope));
  double least = step.startState.segment<4>(at).norm();
  for (double i = 1; i <= samples; ++i) least = std::min(least, componentsAt<4>(step, at, i / samples).norm());
  return std::max(kShortestQuaternion, least - slope / (2 * samples));
}

}  // namespace

RigidTransform poseAt(const Step& step, int body, double fraction) {
  if (body == kFixed) return {};
  const Pose pose = componentsAt<kPoseSize>(step, body * kPoseSize, fraction);
  return {Quat(pose[3], pose[4], pose[5], pose[6]).normalized(), pose.head<3>()};
}

double motionBound(const Step& step, int body, double reach) {
  if (body == kFixed) return 0;
  const Eigen::Index at = body * kPoseSize;
  const double quaternionSlope = slopeBound<4>(step, at + 3);
  // A unit quaternion that moves by a turns the body by 2 a.
  const double turn = 2 * quaternionSlope / leastLength(step, at + 3, quaternionSlope);
  return slopeBound<3>(step, at) + turn * reach;
}

}  // namespace cradle
