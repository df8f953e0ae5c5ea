#include "math/rotation.h"

#include <cmath>

#include "core/error.h"
#include "math/elementary.h"

namespace cradle {
namespace {

constexpr double kNearlyOpposite = 1e-4;  // of the sum of two unit vectors: below, rounding turns their cross product

}  // namespace

Quat rotationAbout(const Vec3& axis, double angle) {
  const SinCos half = sinCos(angle / 2);
  const Vec3 vector = half.sin * axis.normalized();
  return {half.cos, vector.x(), vector.y(), vector.z()};
}

// (Eigen's FromTwoVectors is off by 5e-10 at a thousandth before half a turn, and compiles a singular value
// decomposition into each source that calls it.)
Quat rotationBetween(const Vec3& from, const Vec3& to) {
  const Vec3 start = from.normalized(), end = to.normalized();
  const double twiceHalfCosine = (start + end).norm();
  if (twiceHalfCosine > kNearlyOpposite) {
    const Vec3 vector = start.cross(end) / twiceHalfCosine;
    return {twiceHalfCosine / 2, vector.x(), vector.y(), vector.z()};
  }
  Eigen::Index least = 0;
  start.cwiseAbs().minCoeff(&least);
  const Vec3 across = start.cross(Vec3::Unit(least)).normalized();
  return rotationBetween(-start, end) * Quat(0, across.x(), across.y(), across.z());
}

Quat rotationFromEuler(const std::array<double, 3>& angles, const std::string& order) {
  CRADLE_CHECK(order.size() == 3);
  Quat rotation = Quat::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    CRADLE_CHECK(order[i] >= 'x' && order[i] <= 'z');
    rotation = rotation * rotationAbout(Vec3::Unit(order[i] - 'x'), angles[i]);
  }
  return rotation;
}

Quat orientationRate(const Quat& worldFromBody, const Vec3& angularVelocity) {
  const Vec3 half = 0.5 * angularVelocity;
  return Quat(0, half.x(), half.y(), half.z()) * worldFromBody;
}

}  // namespace cradle
