#pragma once

// Products, scaling and steps in the Lorentz cone |t| <= n of vectors (t1, t2, n): F. Alizadeh, D. Goldfarb,
// "Second-order cone programming", Math. Programming 95, 2003; scaling of Yu. Nesterov and M. Todd as in L.
// Vandenberghe, "The CVXOPT linear and quadratic cone program solvers", 2010, 4.

#include <cmath>
#include <limits>

#include "math/types.h"

namespace cradle {

/// n^2 - |t|^2: positive inside the cone and its mirror image.
inline double coneDeterminant(const Vec3& x) {
  return x.z() * x.z() - x.x() * x.x() - x.y() * x.y();
}

inline Vec3 coneProduct(const Vec3& a, const Vec3& b) {
  return {a.z() * b.x() + b.z() * a.x(), a.z() * b.y() + b.z() * a.y(), a.dot(b)};
}

/// x with coneProduct(a, x) = b, a inside the cone.
inline Vec3 coneQuotient(const Vec3& b, const Vec3& a) {
  const double n = (a.z() * b.z() - a.x() * b.x() - a.y() * b.y()) / coneDeterminant(a);
  return {(b.x() - n * a.x()) / a.z(), (b.y() - n * a.y()) / a.z(), n};
}

/// The symmetric W with W y = W^-1 x, and its inverse, of x and y inside the cone.
struct ConeScaling {
  Mat3 scale = Mat3::Identity(), inverse = Mat3::Identity();
};
inline ConeScaling coneScaling(const Vec3& x, const Vec3& y) {
  const double rootX = std::sqrt(coneDeterminant(x)), rootY = std::sqrt(coneDeterminant(y));
  const Vec3 a = x / rootX, b = y / rootY;
  const double middle = std::sqrt((1 + a.dot(b)) / 2), size = std::sqrt(rootX / rootY);
  const Eigen::Vector2d t = (a.head<2>() - b.head<2>()) / (2 * middle);
  const double n = (a.z() + b.z()) / (2 * middle);
  ConeScaling scaling;
  scaling.scale.topLeftCorner<2, 2>() = Eigen::Matrix2d::Identity() + t * t.transpose() / (1 + n);
  scaling.scale.topRightCorner<2, 1>() = t;
  scaling.scale.bottomLeftCorner<1, 2>() = t.transpose();
  scaling.scale(2, 2) = n;
  scaling.inverse = scaling.scale / size;
  scaling.scale *= size;
  scaling.inverse.topRightCorner<2, 1>() *= -1;
  scaling.inverse.bottomLeftCorner<1, 2>() *= -1;
  return scaling;
}

/// How far x can go along d before it leaves the cone; infinity if it never does.
inline double stepToBoundary(const Vec3& x, const Vec3& d) {
  const double a = coneDeterminant(d), b = x.z() * d.z() - x.x() * d.x() - x.y() * d.y(), c = coneDeterminant(x);
  const double discriminant = b * b - a * c;
  const double divisor = discriminant > 0 ? std::sqrt(discriminant) - b : 0;
  return divisor > 0 ? c / divisor : std::numeric_limits<double>::infinity();
}

}  // namespace cradle
