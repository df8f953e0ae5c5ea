#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "dynamics/constraint_rows.h"

namespace cradle {

/// Solves J M^-1 J^T lambda = b for a set of rows and applies M^-1 J^T lambda, with a direct factorisation: exact at
/// any mass ratio. Redundant rows get the multipliers of least norm. Keeps its memory between calls.
class ConstraintSolver {
 public:
  /// Takes the rows of `rods` in `state` and factorises. O(rows^3).
  void setRows(const std::vector<RodConstraint>& rods, const std::vector<RigidBody>& bodies, const VectorX& state);

  const std::vector<ConstraintRow>& rows() const { return rows_; }

  /// Multipliers of a right-hand side (one entry a row).
  const VectorX& solve(const VectorX& rightHandSide);

  /// The change that multipliers make to a body: M^-1 J^T lambda, linear (first) and angular (second), world frame.
  std::pair<Vec3, Vec3> response(Eigen::Index body, const VectorX& multipliers) const;

 private:
  struct RowResponse {
    Vec3 linearA, angularA, linearB, angularB;  // M^-1 J^T of one row
  };
  double couple(const RowResponse& response, const ConstraintRow& from, const ConstraintRow& to) const;

  std::vector<ConstraintRow> rows_;
  std::vector<RowResponse> responses_;
  MatrixX matrix_;
  Eigen::LDLT<MatrixX> factor_;
  bool isRegular_ = true;
  VectorX multipliers_;
};

/// Moves the bodies by the least (mass-weighted) motion until all rods have their length, then takes out of the
/// velocities what would change it. Returns the largest length error that was found, in m.
double projectOntoRods(const std::vector<RodConstraint>& rods, const std::vector<RigidBody>& bodies,
                       ConstraintSolver& solver, VectorX& state);

/// The second half of projectOntoRods alone: velocities. Returns the largest |J v| / length found, in m/s.
double projectVelocitiesOntoRods(const std::vector<RodConstraint>& rods, const std::vector<RigidBody>& bodies,
                                 ConstraintSolver& solver, VectorX& state);

}  // namespace cradle
