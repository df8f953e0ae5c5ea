#pragma once

#include <algorithm>
#include <cmath>

#include "math/types.h"

namespace cradle {

/// The point nearest to `z` = (t1, t2, n) in Coulomb's cone |t| <= friction n.
inline Vec3 projectOnCone(const Vec3& z, double friction) {
  const double tangential = std::sqrt(z.x() * z.x() + z.y() * z.y()), normal = z.z();
  if (friction * tangential <= -normal) return Vec3::Zero();
  if (tangential <= friction * normal) return z;
  const double nearest = (friction * tangential + normal) / (1 + friction * friction);
  const double part = tangential > 0 ? friction * nearest / tangential : 0;
  return {part * z.x(), part * z.y(), nearest};
}

/// De Saxce's correction: impulses z and velocities u obey Coulomb's law with u_n >= 0 if and only if z is in the cone,
/// u + (0, 0, friction |u_t|) in its dual, and both are perpendicular.
inline Vec3 correctedVelocity(const Vec3& u, double friction) {
  return {u.x(), u.y(), u.z() + friction * std::sqrt(u.x() * u.x() + u.y() * u.y())};
}

/// How far a contact is from Coulomb's law, for impulses and velocities in units that make them comparable: zero if and
/// only if it holds.
inline Vec3 coulombResidual(const Vec3& z, const Vec3& u, double friction) {
  return z - projectOnCone(z - correctedVelocity(u, friction), friction);
}

/// The same for the law of a contact that slides already, in the unit direction `direction` (t1, t2): z_n >= 0,
/// u_n >= 0, z_n u_n = 0 and z_t = -friction z_n direction.
inline Vec3 slidingResidual(const Vec3& z, const Vec3& u, double friction, const Eigen::Vector2d& direction) {
  const Eigen::Vector2d tangential = z.head<2>() + friction * z.z() * direction;
  return {tangential.x(), tangential.y(), z.z() - std::max(0.0, z.z() - u.z())};
}

}  // namespace cradle
