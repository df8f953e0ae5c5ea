#pragma once

#include <functional>
#include <vector>

#include "math/types.h"

namespace cradle {

/// A linear equation of a contact between changes of its impulse and of its velocity: ofImpulse dz + ofVelocity du =
/// side. An open contact has dz = 0.
struct ContactEquation {
  Mat3 ofImpulse = Mat3::Identity(), ofVelocity = Mat3::Identity();
  bool isOpen = false;
};

/// The Delassus operator W = J M^-1 J^T of contacts, as solvers of frictional contact problems ask for it: in units in
/// which each contact has about inverse mass 1, so that light and heavy bodies converge together. Impulses (N s) are
/// the scaled ones times the contact's scale, velocities (m/s) the scaled ones divided by it. Components (t1, t2, n).
struct DelassusOperator {
  VectorX scales;       // by contact, square root of kg
  double largest = 1;   // upper bound on the eigenvalues of the scaled W
  double minShift = 0;  // with a smaller shift the factors of factorizeShifted are rounding
  /// W z.
  std::function<VectorX(const VectorX& z)> multiply;
  /// The largest component of |W| |z|: the rounding of multiply, in units of the last place.
  std::function<double(const VectorX& z)> magnitude;
  /// Prepares `solve` for one equation a contact. False if the equations are known to be singular to rounding: they
  /// have many solutions, among which rounding chooses.
  std::function<bool(const std::vector<ContactEquation>& equations)> factorize;
  /// Prepares `solve` for the solution of least norm. Null where there is no dense matrix.
  std::function<void(const std::vector<ContactEquation>& equations)> factorizeForLeast;
  /// Prepares `solve` for shift dz + du = side in all contacts: a symmetric system, at half the cost.
  std::function<void(double shift)> factorizeShifted;
  /// The solution dz of the equations with du = W dz, which is put into `velocities` unless that is null.
  std::function<VectorX(const VectorX& sides, VectorX* velocities)> solve;
};

/// The scale of each contact of a matrix, three rows a contact (1/kg): 1 over the square root of its mean inverse mass.
VectorX scalesOf(const MatrixX& delassus);

/// The operator of a symmetric positive semi-definite matrix (1/kg) with three rows a contact. `factorize` is
/// O(contacts^3).
DelassusOperator operatorOf(const MatrixX& delassus);

}  // namespace cradle
