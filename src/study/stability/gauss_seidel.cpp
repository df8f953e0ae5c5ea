// The solver of E. Catto, "Iterative Dynamics with Temporal Coherence" (GDC 2005).

#include "study/stability/gauss_seidel.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

namespace cradle {
namespace {

using Index = Eigen::Index;

void accelerate(int body, const Vec3& linear, const Vec3& angular, VectorX& state) {
  if (body == kFixed) return;
  linearVelocity(state, body) += linear;
  angularVelocity(state, body) += angular;
}

}  // namespace

GaussSeidel::GaussSeidel(std::vector<ConstraintRow> rows, RowKind kind, const std::vector<RigidBody>& bodies,
                         VectorX state)
    : rows_(std::move(rows)), kind_(kind), state_(std::move(state)) {
  const auto respond = [&](int body, const Vec3& linear, const Vec3& angular, Vec3& linearOut, Vec3& angularOut) {
    linearOut = angularOut = Vec3::Zero();
    if (body == kFixed) return 0.0;
    const RigidBody& rigid = bodies[static_cast<std::size_t>(body)];
    linearOut = rigid.inverseMass * linear;
    angularOut = worldInverseInertia(rigid, orientation(state_, body)) * angular;
    return linear.dot(linearOut) + angular.dot(angularOut);
  };
  for (const ConstraintRow& row : rows_) {
    Response& response = responses_.emplace_back();
    response.inverseMass = respond(row.bodyA, row.linearA, row.angularA, response.linearA, response.angularA) +
                           respond(row.bodyB, row.linearB, row.angularB, response.linearB, response.angularB);
  }
}

void GaussSeidel::sweep() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Response& response = responses_[i];
    const double before = response.multiplier;
    response.multiplier -= rateOf(rows_[i], state_) / response.inverseMass;
    if (kind_ == RowKind::pushes) response.multiplier = std::max(0.0, response.multiplier);
    const double change = response.multiplier - before;
    accelerate(rows_[i].bodyA, change * response.linearA, change * response.angularA, state_);
    accelerate(rows_[i].bodyB, change * response.linearB, change * response.angularB, state_);
  }
}

MatrixX GaussSeidel::matrix() const {
  const Index size = std::ssize(rows_);
  MatrixX result(size, size);
  for (Index column = 0; column < size; ++column) {
    const ConstraintRow& row = rows_[static_cast<std::size_t>(column)];
    const Response& response = responses_[static_cast<std::size_t>(column)];
    VectorX answer = VectorX::Zero(state_.size());
    accelerate(row.bodyA, response.linearA, response.angularA, answer);
    accelerate(row.bodyB, response.linearB, response.angularB, answer);
    for (Index other = 0; other < size; ++other)
      result(other, column) = rateOf(rows_[static_cast<std::size_t>(other)], answer);
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
