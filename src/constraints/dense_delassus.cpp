#include "constraints/dense_delassus.h"

#include <utility>

namespace cradle {

using Index = Eigen::Index;

bool isImmobile(double inverseMass, double unconstrainedInverseMass) {
  constexpr double kImmobileRatio = 1e-12;  // the square of a moment arm, in sizes of a body; constraints leave 1e-16
  return inverseMass <= kImmobileRatio * unconstrainedInverseMass;
}

DenseDelassus::DenseDelassus(std::vector<ConstraintBlock> blocks, const std::vector<RigidBody>& bodies,
                             const std::vector<BodyFrame>& frames, ConstraintSolver* constraints)
    : blocks_(std::move(blocks)) {
  Index size = 0;
  for (const ConstraintBlock& block : blocks_) size += block.rows;
  matrix_.resize(size, size), unconstrainedDiagonal_.resize(size);
  BlockResponse alone;
  for (const ConstraintBlock& block : blocks_) {
    findResponse(block, bodies, frames, alone);
    for (int row = 0; row < block.rows; ++row) {
      const Index column = std::ssize(responses_);
      ConstraintBlock::Values multipliers{};
      multipliers[static_cast<std::size_t>(row)] = 1;
      VectorX response = VectorX::Zero(stateSize(std::ssize(bodies)));
      addResponse(block, alone, multipliers.data(), response);
      unconstrainedDiagonal_[column] = rateOf(block, row, response);
      if (constraints && constraints->hasConstraints()) constraints->constrainVelocities(response);
      matrix_.col(column) = velocities(response);
      responses_.push_back(std::move(response));
    }
  }
  matrix_ = (0.5 * (matrix_ + matrix_.transpose())).eval();
}

bool DenseDelassus::isImmobile(Index row) const {
  return cradle::isImmobile(matrix_(row, row), unconstrainedDiagonal_[row]);
}

VectorX DenseDelassus::velocities(const VectorX& state) const {
  VectorX result(matrix_.rows());
  double* next = result.data();
  for (const ConstraintBlock& block : blocks_) {
    withRows(block.rows, [&](auto rows) { findRates<rows>(block, state, next); });
    next += block.rows;
  }
  return result;
}

VectorX DenseDelassus::accelerations(const VectorX& derivative) const {
  VectorX result = velocities(derivative);
  double* next = result.data();
  for (const ConstraintBlock& block : blocks_)
    for (std::size_t row = 0; row < static_cast<std::size_t>(block.rows); ++row) *next++ += block.velocityProduct[row];
  return result;
}

void DenseDelassus::apply(const VectorX& impulses, VectorX& state) const {
  const Index from = poseComponents(state), size = bodyCount(state) * kVelocitySize;
  for (std::size_t i = 0; i < responses_.size(); ++i)
    state.segment(from, size) += impulses[static_cast<Index>(i)] * responses_[i].segment(from, size);
}

}  // namespace cradle
