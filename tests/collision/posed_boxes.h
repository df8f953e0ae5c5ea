#pragma once

#include "collision/predicted_manifold.h"

// Places of boxes, for tests of their contacts.

namespace cradle {

inline constexpr double kExact = 1e-14;  // m: rounding of coordinates below 1 m
inline const Mat3 kStraight = Mat3::Identity();

inline Mat3 turnedAbout(const Vec3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}

}  // namespace cradle
