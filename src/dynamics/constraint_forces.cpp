// Constraint forces by the Schur complement J M^-1 J^T, factorised directly (D. Baraff, "Linear-time dynamics using
// Lagrange multipliers", SIGGRAPH 1996, section 3, without its sparsity: rows are few).

#include "dynamics/constraint_forces.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace cradle {
namespace {

constexpr double kRankTolerance = 1e-12;    // pivots below this part of the largest are redundancy, not stiffness
constexpr double kLengthTolerance = 1e-15;  // of length^2: where Newton's method stops gaining in double precision
constexpr int kMostProjectionSteps = 10;    // quadratic convergence needs 1 or 2 from a step's error

}  // namespace

void ConstraintSolver::setRows(const std::vector<RodConstraint>& rods, const std::vector<RigidBody>& bodies,
                               const VectorX& state) {
  rows_.clear();
  responses_.clear();
  for (const RodConstraint& rod : rods) {
    const ConstraintRow row = rowOf(rod, state);
    RowResponse response{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    if (row.bodyA != kFixed) {
      const RigidBody& a = bodies[static_cast<std::size_t>(row.bodyA)];
      response.linearA = a.inverseMass * row.linearA;
      response.angularA = worldInverseInertia(a, orientation(state, row.bodyA)) * row.angularA;
    }
    if (row.bodyB != kFixed) {
      const RigidBody& b = bodies[static_cast<std::size_t>(row.bodyB)];
      response.linearB = b.inverseMass * row.linearB;
      response.angularB = worldInverseInertia(b, orientation(state, row.bodyB)) * row.angularB;
    }
    rows_.push_back(row);
    responses_.push_back(response);
  }
  const Eigen::Index count = static_cast<Eigen::Index>(rows_.size());
  matrix_.resize(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j <= i; ++j) {
      const std::size_t from = static_cast<std::size_t>(i), to = static_cast<std::size_t>(j);
      matrix_(i, j) = matrix_(j, i) = couple(responses_[from], rows_[from], rows_[to]);
    }
  factor_.compute(matrix_);
  const auto pivots = factor_.vectorD().cwiseAbs();
  isRegular_ = count == 0 || pivots.minCoeff() > kRankTolerance * pivots.maxCoeff();
}

double ConstraintSolver::couple(const RowResponse& response, const ConstraintRow& from, const ConstraintRow& to) const {
  double sum = 0;
  const auto add = [&](int body, const Vec3& linear, const Vec3& angular) {
    if (body == kFixed) return;
    if (body == to.bodyA) sum += linear.dot(to.linearA) + angular.dot(to.angularA);
    if (body == to.bodyB) sum += linear.dot(to.linearB) + angular.dot(to.angularB);
  };
  add(from.bodyA, response.linearA, response.angularA);
  add(from.bodyB, response.linearB, response.angularB);
  return sum;
}

const VectorX& ConstraintSolver::solve(const VectorX& rightHandSide) {
  if (isRegular_) {
    multipliers_ = factor_.solve(rightHandSide);
  } else {
    Eigen::CompleteOrthogonalDecomposition<MatrixX> factor;
    factor.setThreshold(kRankTolerance);
    multipliers_ = factor.compute(matrix_).solve(rightHandSide);
  }
  return multipliers_;
}

std::pair<Vec3, Vec3> ConstraintSolver::response(Eigen::Index body, const VectorX& multipliers) const {
  std::pair<Vec3, Vec3> sum{Vec3::Zero(), Vec3::Zero()};
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const double multiplier = multipliers[static_cast<Eigen::Index>(i)];
    if (rows_[i].bodyA == body) {
      sum.first += multiplier * responses_[i].linearA;
      sum.second += multiplier * responses_[i].angularA;
    }
    if (rows_[i].bodyB == body) {
      sum.first += multiplier * responses_[i].linearB;
      sum.second += multiplier * responses_[i].angularB;
    }
  }
  return sum;
}

double projectOntoRods(const std::vector<RodConstraint>& rods, const std::vector<RigidBody>& bodies,
                       ConstraintSolver& solver, VectorX& state) {
  if (rods.empty()) return 0;
  double lengthError = 0;
  VectorX residual(static_cast<Eigen::Index>(rods.size()));
  for (int iteration = 0; iteration < kMostProjectionSteps; ++iteration) {
    solver.setRows(rods, bodies, state);
    double worst = 0;
    for (std::size_t i = 0; i < rods.size(); ++i) {
      const double value = solver.rows()[i].value, length = rods[i].length;
      residual[static_cast<Eigen::Index>(i)] = -value;
      worst = std::max(worst, std::abs(value) / (length * length));
      if (iteration == 0) lengthError = std::max(lengthError, std::abs(value) / length);
    }
    if (!(worst > kLengthTolerance)) break;
    const VectorX& multipliers = solver.solve(residual);
    for (Eigen::Index body = 0; body < bodyCount(state); ++body) {
      const auto [shift, turn] = solver.response(body, multipliers);
      centerOfMass(state, body) += shift;
      turnBody(state, body, turn);
    }
  }
  projectVelocitiesOntoRods(rods, bodies, solver, state);
  return lengthError;
}

double projectVelocitiesOntoRods(const std::vector<RodConstraint>& rods, const std::vector<RigidBody>& bodies,
                                 ConstraintSolver& solver, VectorX& state) {
  if (rods.empty()) return 0;
  solver.setRows(rods, bodies, state);
  VectorX residual(static_cast<Eigen::Index>(rods.size()));
  double worst = 0;
  for (std::size_t i = 0; i < rods.size(); ++i) {
    residual[static_cast<Eigen::Index>(i)] = -rateOf(solver.rows()[i], state);
    worst = std::max(worst, std::abs(residual[static_cast<Eigen::Index>(i)]) / rods[i].length);
  }
  const VectorX& multipliers = solver.solve(residual);
  for (Eigen::Index body = 0; body < bodyCount(state); ++body) {
    const auto [push, spin] = solver.response(body, multipliers);
    linearVelocity(state, body) += push;
    angularVelocity(state, body) += spin;
  }
  return worst;
}

}  // namespace cradle
