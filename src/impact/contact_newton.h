#pragma once

// Newton's method on the equations of P. Alart and A. Curnier, "A mixed formulation for frictional contact problems
// prone to Newton like solution methods", 1991, for impulses and velocities scaled to inverse mass 1.

#include "impact/delassus_operator.h"

namespace cradle {

/// A contact that does not push is left out: z = 0.
inline bool pushes(const Vec3& z, const Vec3& u) {
  return z.z() > u.z();
}

/// The function whose root is sought, F(z, u), of a contact that pushes, and its derivatives dF/dz, dF/du: the equation
/// of a step has the side -F.
struct NewtonRow {
  ContactEquation equation;
  Vec3 value;
};

/// `regular` is a small inverse mass that makes redundant contacts solvable.
inline NewtonRow newtonRow(const Vec3& z, const Vec3& u, double friction, double regular) {
  NewtonRow row;
  const double pressing = z.z() - u.z();
  auto& [ofImpulse, ofVelocity, isOpen] = row.equation;
  ofImpulse = regular * Mat3::Identity();
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
  ofImpulse.topLeftCorner<2, 2>() = Mat2::Identity() - (1 - kSticky) * turning;
  ofImpulse.topRightCorner<2, 1>() = -friction * e;
  ofVelocity.topLeftCorner<2, 2>() = turning;
  ofVelocity.topRightCorner<2, 1>() = friction * e;
  row.value.head<2>() = z.head<2>() - friction * pressing * e;
  return row;
}

}  // namespace cradle
