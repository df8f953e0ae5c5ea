// The solver of E. Catto, "Iterative Dynamics with Temporal Coherence" (GDC 2005).

#include "study/stability/gauss_seidel.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

namespace cradle {
namespace {

using Index = Eigen::Index;

}  // namespace

GaussSeidel::GaussSeidel(std::vector<ConstraintBlock> rows, RowKind kind, const std::vector<RigidBody>& bodies,
                         VectorX state)
    : rows_(std::move(rows)), kind_(kind), state_(std::move(state)) {
  std::vector<BodyFrame> frames;
  findBodyFrames(bodies, state_, frames);
  for (const ConstraintBlock& row : rows_) {
    findResponse(row, bodies, frames, responses_.emplace_back());
    inverseMasses_.push_back(mobilityOf(row, bodies, frames));
  }
  multipliers_.assign(rows_.size(), 0);
}

void GaussSeidel::sweep() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double before = multipliers_[i];
    multipliers_[i] -= rateOf(rows_[i], 0, state_) / inverseMasses_[i];
    if (kind_ == RowKind::pushes) multipliers_[i] = std::max(0.0, multipliers_[i]);
    const double impulse = multipliers_[i] - before;
    addResponse(rows_[i], responses_[i], &impulse, state_);
  }
}

MatrixX GaussSeidel::matrix() const {
  const Index size = std::ssize(rows_);
  MatrixX result = MatrixX::Zero(size, size);
  for (std::size_t column = 0; column < rows_.size(); ++column)
    for (std::size_t row = 0; row < rows_.size(); ++row) {
      const SharedBodies shared = sharedBodies(rows_[row], rows_[column]);
      double& entry = result(static_cast<Index>(row), static_cast<Index>(column));
      if (shared.any()) putDelassus<1, 1>(rows_[row], rows_[column], shared, responses_[column], &entry, 1);
    }
  return result;
}

double convergenceFactor(const MatrixX& matrix) {
  const VectorX roots = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixX scaled = roots.asDiagonal() * matrix * roots.asDiagonal();
  // Jacobi's iteration is 1 - scaled, its eigenvalues are symmetric about 0: the largest is 1 - the least of `scaled`.
  const double jacobi = 1 - Eigen::SelfAdjointEigenSolver<MatrixX>(scaled, Eigen::EigenvaluesOnly).eigenvalues()[0];
  return jacobi * jacobi;
}

}  // namespace cradle
