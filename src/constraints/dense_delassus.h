#pragma once

#include <vector>

#include "constraints/constraint_forces.h"

namespace cradle {

/// Whether constraints leave a direction no motion, with these inverse masses (1/kg) along it.
bool isImmobile(double inverseMass, double unconstrainedInverseMass);

/// The Delassus operator W = J (M^-1 - M^-1 B^T (B M^-1 B^T)^-1 B M^-1) J^T of rows J as a dense matrix, B the rows of
/// the bodies' constraints, which answer within the same impulse. O(rows x (rows + bodies)) and a solution of
/// `constraints` for each row. No factorisation of its own.
class DenseDelassus {
 public:
  /// The bodies have `frames`; `constraints` must be factorised for their places, or null: there are none.
  DenseDelassus(std::vector<ConstraintBlock> blocks, const std::vector<RigidBody>& bodies,
                const std::vector<BodyFrame>& frames, ConstraintSolver* constraints);

  /// In 1/kg: from impulses to velocities of the rows, or from forces to accelerations.
  const MatrixX& matrix() const { return matrix_; }

  /// The diagonal entry of a row as it were without constraints, in 1/kg.
  double unconstrainedDiagonal(Eigen::Index row) const { return unconstrainedDiagonal_[row]; }

  /// Whether the constraints let a row's velocity only be what it is.
  bool isImmobile(Eigen::Index row) const;

  /// J v for the velocities in `state`.
  VectorX velocities(const VectorX& state) const;

  /// J a + (dJ/dt) v for the accelerations in `derivative`.
  VectorX accelerations(const VectorX& derivative) const;

  /// Adds to the velocities in `state` what impulses (N s) give, or to accelerations what forces (N) do.
  void apply(const VectorX& impulses, VectorX& state) const;

 private:
  std::vector<ConstraintBlock> blocks_;
  std::vector<VectorX> responses_;  // of all bodies to each row, with the constraints
  VectorX unconstrainedDiagonal_;
  MatrixX matrix_;
};

}  // namespace cradle
