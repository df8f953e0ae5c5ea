#include "constraints/dense_delassus.h"

#include <utility>

namespace cradle {

using Index = Eigen::Index;

bool isImmobile(double inverseMass, double unconstrainedInverseMass) {
  constexpr double kImmobileRatio = 1e-12;  // the square of a moment arm, in sizes of a body; constraints leave 1e-16
  return inverseMass <= kImmobileRatio * unconstrainedInverseMass;
}

DenseDelassus::DenseDelassus(std::vector<ConstraintRow> rows, const std::vector<RigidBody>& bodies,
                             const std::vector<BodyFrame>& frames, ConstraintSolver* constraints)
    : rows_(std::move(rows)), unconstrainedDiagonal_(std::ssize(rows_)), matrix_(std::ssize(rows_), std::ssize(rows_)) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const RowResponse alone = responseTo(rows_[i], bodies, frames);
    VectorX response = VectorX::Zero(stateSize(std::ssize(bodies)));
    addResponse(rows_[i], alone, 1, response);
    if (constraints && constraints->hasConstraints()) constraints->constrainVelocities(response);
    unconstrainedDiagonal_[static_cast<Index>(i)] = delassusEntry(rows_[i], rows_[i], alone);
    matrix_.col(static_cast<Index>(i)) = velocities(response);
    responses_.push_back(std::move(response));
  }
  matrix_ = (0.5 * (matrix_ + matrix_.transpose())).eval();
}

bool DenseDelassus::isImmobile(Index row) const {
  return cradle::isImmobile(matrix_(row, row), unconstrainedDiagonal_[row]);
}

VectorX DenseDelassus::velocities(const VectorX& state) const {
  VectorX result(rows_.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) result[static_cast<Index>(i)] = rateOf(rows_[i], state);
  return result;
}

VectorX DenseDelassus::accelerations(const VectorX& derivative) const {
  VectorX result = velocities(derivative);
  for (std::size_t i = 0; i < rows_.size(); ++i) result[static_cast<Index>(i)] += rows_[i].velocityProduct;
  return result;
}

void DenseDelassus::apply(const VectorX& impulses, VectorX& state) const {
  const Index from = poseComponents(state), size = bodyCount(state) * kVelocitySize;
  for (std::size_t i = 0; i < responses_.size(); ++i)
    state.segment(from, size) += impulses[static_cast<Index>(i)] * responses_[i].segment(from, size);
}

}  // namespace cradle
