#pragma once

// Newton's method on the equations of P. Alart and A. Curnier, "A mixed formulation for frictional contact problems
// prone to Newton like solution methods", 1991, for impulses z and velocities u = W z + g scaled to inverse mass 1.
// With z' = z - u, a contact of friction coefficient mu is
//   open     if z'_n <= 0:                   z = 0
//   sticking if |z'_t| <= mu z'_n:           u = 0
//   sliding  else, with e = z'_t / |z'_t|:   z_t - mu z'_n e = 0 and u_n = 0.   (1)
// Forces of a contact that slides already, in the unit direction d, have e = -d:
//   open     if z'_n <= 0:                   z = 0
//   sliding  else:                           z_t + mu z_n d = 0 and u_n = 0.        (2)

#include "impact/delassus_operator.h"

namespace cradle {

/// Whether a contact is not open: z'_n > 0.
inline bool pushes(const Vec3& z, const Vec3& u) {
  return z.z() > u.z();
}

/// The function F(z, u) whose root is sought, of a contact that is not open, and the matrices dF/dz and dF/du of its
/// equation dF/dz dz + dF/du du = -F for a step.
struct NewtonRow {
  ContactEquation equation;
  Vec3 value;
};

/// `regular` is a small inverse mass (scaled) that is added to the diagonal: without it the equations of redundant
/// contacts are singular.
inline NewtonRow newtonRow(const Vec3& z, const Vec3& u, double friction, double regular) {
  NewtonRow row;
  const double pressing = z.z() - u.z();
  auto& [ofImpulse, ofVelocity, isOpen] = row.equation;
  ofImpulse = regular * Mat3::Identity();
  row.value = u;  // sticks
  const Eigen::Vector2d pull = z.head<2>() - u.head<2>();
  const double size = pull.norm();
  if (size <= friction * pressing && friction > 0) return row;
  // Equation (1). At the border to sticking, where |z'_t| = mu z'_n, dF/dz would be 1 - (1 - e e^T) in the tangent
  // plane, which is singular; kSticky, about 1e3 unit roundoffs, keeps it regular and changes steps by no more than
  // 1e-13.
  constexpr double kSticky = 1e-13;
  using Mat2 = Eigen::Matrix2d;
  const Eigen::Vector2d e = size > 0 ? Eigen::Vector2d(pull / size) : Eigen::Vector2d::Zero();
  const Mat2 turning =
      size > 0 ? Mat2(friction * pressing / size * (Mat2::Identity() - e * e.transpose())) : Mat2::Zero();
  ofImpulse.topLeftCorner<2, 2>() = Mat2::Identity() - (1 - kSticky) * turning;
  ofImpulse.topRightCorner<2, 1>() = -friction * e;
  ofVelocity.topLeftCorner<2, 2>() = turning;
  ofVelocity.topRightCorner<2, 1>() = friction * e;
  row.value.head<2>() = z.head<2>() - friction * pressing * e;
  return row;
}

/// The same by equation (2), of a contact that slides in `direction`.
inline NewtonRow slidingRow(const Vec3& z, const Vec3& u, double friction, const Eigen::Vector2d& direction,
                            double regular) {
  NewtonRow row;
  row.equation.ofImpulse = Mat3::Identity();
  row.equation.ofImpulse.topRightCorner<2, 1>() = friction * direction;
  row.equation.ofImpulse(2, 2) = regular;
  row.equation.ofVelocity = Vec3::UnitZ() * Vec3::UnitZ().transpose();
  row.value << z.head<2>() + friction * z.z() * direction, u.z();
  return row;
}

}  // namespace cradle
