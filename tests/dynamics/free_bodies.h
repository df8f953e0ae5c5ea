#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <random>

#include "dynamics/free_rotation.h"
#include "math/rotation.h"

// Freely turning bodies for tests.

namespace cradle {

/// Length of the difference, q and -q being the same.
inline double distance(const Quat& a, const Quat& b) {
  return std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm());
}

struct Case {
  Mat3 inertiaTensor;
  RotationState start;
};

class Random {
 public:
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  Vec3 vector() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }
  Quat rotation() {
    const Vec3 axis = vector();
    return rotationAbout(axis, between(0, std::numbers::pi));
  }
  /// Moments as of a real body: no one above the sum of the others.
  Vec3 moments() {
    const Vec3 extents{between(0.1, 1), between(0.1, 1), between(0.1, 1)};
    return {extents.y() + extents.z(), extents.z() + extents.x(), extents.x() + extents.y()};
  }

 private:
  std::mt19937_64 bits_{1};
};

/// A body with these moments, its principal axes and orientation turned at random, that spins with `spin` (principal
/// axes).
inline Case turned(const Vec3& moments, const Vec3& spin, Random& random) {
  const Quat bodyFromAxes = random.rotation(), worldFromBody = random.rotation();
  const Mat3 rotation = bodyFromAxes.toRotationMatrix(),
             tensor = rotation * moments.asDiagonal() * rotation.transpose();
  return {(tensor + tensor.transpose()) / 2, {worldFromBody, worldFromBody * (bodyFromAxes * spin)}};
}

inline Case anyBody(Random& random) {
  const Vec3 moments = random.moments(), spin = random.vector();
  return turned(moments, spin, random);
}

/// As it stands, not turned: moments and spin keep their bits.
inline Case straight(const Vec3& moments, const Vec3& spin) {
  return {moments.asDiagonal(), {Quat::Identity(), spin}};
}

}  // namespace cradle
