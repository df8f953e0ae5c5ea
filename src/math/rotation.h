#pragma once

#include <array>
#include <string>

#include "math/types.h"

namespace cradle {

/// Rotation by `angle` (rad) about `axis` (any non-zero length), counter-clockwise seen from its tip.
Quat rotationAbout(const Vec3& axis, double angle);

/// The shortest rotation that takes the direction of `from` to that of `to` (any non-zero lengths); of opposite
/// directions (sum of unit vectors below 1e-4), about half a turn about some axis across them.
Quat rotationBetween(const Vec3& from, const Vec3& to);

/// Euler angles in any order: "zyx" is R = Rz(angles[0]) Ry(angles[1]) Rx(angles[2]), angles in rad. `order` is three
/// letters of x, y, z, neighbours different (Tait-Bryan "zyx" or proper Euler "zxz").
Quat rotationFromEuler(const std::array<double, 3>& angles, const std::string& order);

/// Time derivative of an orientation worldFromBody that turns with `angularVelocity` (rad/s, world):
/// q' = 1/2 (0, w) q.
Quat orientationRate(const Quat& worldFromBody, const Vec3& angularVelocity);

/// The matrix of the cross product: skew(a) b = a x b.
inline Mat3 skew(const Vec3& a) {
  Mat3 matrix;
  matrix << 0, -a.z(), a.y(), a.z(), 0, -a.x(), -a.y(), a.x(), 0;
  return matrix;
}

}  // namespace cradle
