#pragma once

#include <vector>

#include "constraints/block_response.h"

namespace cradle {

/// What a row's multiplier may be.
enum class RowKind {
  holds,  // a rod: any, J v = 0
  pushes  // a contact: >= 0 with J v >= 0, and one of them 0
};

/// The textbook solver of rods and contacts: one row after the other gets the impulse that satisfies it alone, sweep
/// after sweep (projected Gauss-Seidel on J M^-1 J^T, or sequential impulses). It does not stand among the ways in
/// which scenes are simulated: charts show where it fails.
class GaussSeidel {
 public:
  /// Takes blocks of one row each. Starts from the velocities in `state`. O(rows) space.
  GaussSeidel(std::vector<ConstraintBlock> rows, RowKind kind, const std::vector<RigidBody>& bodies, VectorX state);

  /// O(rows).
  void sweep();

  /// With the velocities after the sweeps so far.
  const VectorX& state() const { return state_; }

  /// J M^-1 J^T. O(rows^2).
  MatrixX matrix() const;

 private:
  std::vector<ConstraintBlock> rows_;
  std::vector<BlockResponse> responses_;
  std::vector<double> inverseMasses_, multipliers_;  // the diagonal of J M^-1 J^T; what the sweeps have added up
  RowKind kind_;
  VectorX state_;
};

/// What a sweep leaves of the error in the end: the largest eigenvalue of Gauss-Seidel's iteration. For rows of which
/// each acts on its neighbours alone it is the square of Jacobi's (D. M. Young, "Iterative Solution of Large Linear
/// Systems", 1971, 5.2); M / (M + m) for a body of mass M on one of mass m. `matrix`: J M^-1 J^T.
double convergenceFactor(const MatrixX& matrix);

}  // namespace cradle
