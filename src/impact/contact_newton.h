#pragma once

// Newton's method on the equations of P. Alart and A. Curnier, "A mixed formulation for frictional contact problems
// prone to Newton like solution methods", 1991, for impulses and velocities scaled to inverse mass 1.

#include "math/types.h"

namespace cradle {

/// A contact that does not push is left out: z = 0.
inline bool pushes(const Vec3& z, const Vec3& u) {
  return z.z() > u.z();
}

/// The linearised equations of a contact that pushes: ofImpulse dz + ofVelocity du = -value.
struct NewtonRow {
  Mat3 ofImpulse, ofVelocity;
  Vec3 value;
};

/// `regular` is a small inverse mass that makes redundant contacts solvable.
inline NewtonRow newtonRow(const Vec3& z, const Vec3& u, double friction, double regular) {
  NewtonRow row;
  const double pressing = z.z() - u.z();
  row.ofImpulse = regular * Mat3::Identity();
  row.ofVelocity.setIdentity();
  row.value = u;  // sticks
  const Eigen::Vector2d pull = z.head<2>() - u.head<2>();
  const double size = pull.norm();
  if (size <= friction * pressing && friction > 0) return row;
  // Slides: z_t = friction (z_n - u_n) e.
  constexpr double kSticky = 1e-13;  // what is about to stick leaves the row regular
  using Mat2 = Eigen::Matrix2d;
  const Eigen::Vector2d e = size > 0 ? Eigen::Vector2d(pull / size) : Eigen::Vector2d::Zero();
  const Mat2 turning =
      size > 0 ? Mat2(friction * pressing / size * (Mat2::Identity() - e * e.transpose())) : Mat2::Zero();
  row.ofImpulse.topLeftCorner<2, 2>() = Mat2::Identity() - (1 - kSticky) * turning;
  row.ofImpulse.topRightCorner<2, 1>() = -friction * e;
  row.ofVelocity.topLeftCorner<2, 2>() = turning;
  row.ofVelocity.topRightCorner<2, 1>() = friction * e;
  row.value.head<2>() = z.head<2>() - friction * pressing * e;
  return row;
}

}  // namespace cradle
