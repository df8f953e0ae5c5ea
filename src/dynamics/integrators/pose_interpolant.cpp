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

/// Largest second derivatives of the same; rounded up.
constexpr std::array<double, 4> kCorrectionBends = {2, 2, 0.375, 0.243};

constexpr double kShortestQuaternion = 0.5;  // on the interpolant of any step worth taking

/// How many corrections the interpolant has.
std::size_t correctionsOf(const Step& step) {
  if (step.interpolant == InterpolantKind::degreeFour) return 1;
  return step.interpolant == InterpolantKind::degreeSeven ? 4 : 0;
}

/// Components of the interpolant from `at` on. The quaternion is not of unit length.
template <int kSize>
Eigen::Matrix<double, kSize, 1> componentsAt(const Step& step, Eigen::Index at, double fraction) {
  const double s = fraction, r = 1 - fraction;
  Eigen::Matrix<double, kSize, 1> part = (r * r * (1 + 2 * s)) * step.startState.segment<kSize>(at) +
                                         (s * s * (1 + 2 * r)) * step.state.segment<kSize>(at) +
                                         (step.timeStep * s * r) * (r * step.startDerivative.segment<kSize>(at) -
                                                                    s * step.endDerivative.segment<kSize>(at));
  const auto c = [&](std::size_t i) { return step.corrections[i].segment<kSize>(at); };
  if (step.interpolant == InterpolantKind::degreeFour) part += (s * s * r * r) * c(0);
  if (step.interpolant == InterpolantKind::degreeSeven)
    part += (s * s * r * r) * (c(0) + s * (c(1) + r * (c(2) + s * c(3))));
  return part;
}

/// Whether the components from `at` on stay as they are.
template <int kSize>
bool isConstant(const Step& step, Eigen::Index at) {
  const auto isZero = [at](const VectorX& vector) {
    return vector.segment<kSize>(at) == Eigen::Matrix<double, kSize, 1>::Zero();
  };
  return isZero(step.startDerivative) && isZero(step.endDerivative) &&
         step.startState.segment<kSize>(at) == step.state.segment<kSize>(at) &&
         std::all_of(step.corrections.begin(), step.corrections.begin() + static_cast<int>(correctionsOf(step)),
                     isZero);
}

/// The components of one vector from `at` on.
template <int kSize>
auto componentsFrom(Eigen::Index at) {
  return [at](const VectorX& vector) { return vector.segment<kSize>(at); };
}

/// Positions of B relative to A; either may be fixed.
auto difference(int bodyA, int bodyB) {
  return [bodyA, bodyB](const VectorX& vector) {
    Vec3 result = Vec3::Zero();
    if (bodyB != kFixed) result += vector.segment<3>(bodyB * kPoseSize);
    if (bodyA != kFixed) result -= vector.segment<3>(bodyA * kPoseSize);
    return result;
  };
}

/// Bound on the slope of the interpolant of a part of the state over the unit interval. That of the cubic is h (r f0 +
/// s f1) + 6 s r (y1 - y0 - h (f0 + f1) / 2), with 6 s r <= 3/2; curves of degree 4 and 7 add their corrections.
template <class Part>
double slopeBound(const Step& step, const Part& part) {
  const auto start = (step.timeStep * part(step.startDerivative)).eval(),
             end = (step.timeStep * part(step.endDerivative)).eval();
  const auto bend = (part(step.state) - part(step.startState) - 0.5 * (start + end)).eval();
  double bound = std::max(start.norm(), end.norm()) + 1.5 * bend.norm();
  for (std::size_t i = 0; i < correctionsOf(step); ++i)
    bound += kCorrectionSlopes[i] * part(step.corrections[i]).norm();
  return bound;
}

/// Bound on the second derivative of the same. That of the cubic is linear in s.
template <class Part>
double bendBound(const Step& step, const Part& part) {
  const auto start = (step.timeStep * part(step.startDerivative)).eval(),
             end = (step.timeStep * part(step.endDerivative)).eval();
  const auto way = (part(step.state) - part(step.startState)).eval();
  double bound = std::max((6 * way - 4 * start - 2 * end).norm(), (6 * way - 2 * start - 4 * end).norm());
  for (std::size_t i = 0; i < correctionsOf(step); ++i) bound += kCorrectionBends[i] * part(step.corrections[i]).norm();
  return bound;
}

/// Lower bound on the length of an interpolated quaternion: from the nearest of so many samples it falls by at most
/// 1/8.
double leastLength(const Step& step, Eigen::Index at, double slope) {
  constexpr double kMaxSamples = 32;  // for a slope of 8; with a larger one the bound is coarser
  const double samples = 1 + std::floor(std::min(kMaxSamples, 4 * slope));
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

void interpolatePose(const Step& step, int body, double fraction, VectorX& state) {
  state.segment<kPoseSize>(body * kPoseSize) = componentsAt<kPoseSize>(step, body * kPoseSize, fraction);
}

bool isStill(const Step& step, int body) {
  return body == kFixed || isConstant<kPoseSize>(step, body * kPoseSize);
}

double motionBound(const Step& step, int body, double reach) {
  return isStill(step, body) ? 0 : motionBounds(step, body, reach).speed;
}

// With p = q' / q and its derivative q'' / q - p^2, a body turns at w = 2 Im p: |w| <= 2 |q'| / |q|, and |w'| <= 2
// (|q''| / |q|
// + |q'|^2 / |q|^2). A point at r moves at w x r and accelerates by w' x r + w x (w x r).
MotionBounds turnBounds(const Step& step, int body) {
  if (body == kFixed) return {};
  const Eigen::Index at = body * kPoseSize + 3;
  if (isConstant<4>(step, at)) return {};
  const double slope = slopeBound(step, componentsFrom<4>(at)), least = leastLength(step, at, slope);
  const double relative = slope / least, bend = bendBound(step, componentsFrom<4>(at)) / least;
  return {2 * relative, 2 * bend + 6 * relative * relative};
}

MotionBounds relativeMotionBounds(const Step& step, int bodyA, int bodyB) {
  return {slopeBound(step, difference(bodyA, bodyB)), bendBound(step, difference(bodyA, bodyB))};
}

double motionBoundAcross(const Step& step, int bodyA, int bodyB, const Vec3& direction) {
  const auto apart = difference(bodyA, bodyB);
  return slopeBound(step, [&](const VectorX& vector) {
    const Vec3 part = apart(vector);
    return Vec3(part - part.dot(direction) * direction);
  });
}

double accelerationBoundAlong(const Step& step, int bodyA, int bodyB, const Vec3& direction) {
  const auto apart = difference(bodyA, bodyB);
  return bendBound(step,
                   [&](const VectorX& vector) { return Eigen::Matrix<double, 1, 1>(apart(vector).dot(direction)); });
}

MotionBounds motionBounds(const Step& step, int body, double reach) {
  const MotionBounds shift = relativeMotionBounds(step, kFixed, body), turn = turnBounds(step, body);
  return {shift.speed + turn.speed * reach, shift.acceleration + turn.acceleration * reach};
}

}  // namespace cradle
