#include "impact/delassus_operator.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <memory>

namespace cradle {
namespace {

using Index = Eigen::Index;

// Of the largest pivot: equations with a smaller one are singular. The shift that Newton's method adds to the diagonal
// (kNewtonShift, 1e-9) is smaller still, and so is rounding.
constexpr double kSingularPivotRatio = 1e-7;
// Of the largest eigenvalue: with a smaller shift the condition number of the shifted matrix is above 1e8, and half of
// the digits of its factors are rounding.
constexpr double kMinShiftRatio = 1e-8;

/// The state of the operator of a dense matrix: the scaled matrix, and the factors of the last equations.
struct DenseFactors {
  MatrixX matrix, system;
  std::vector<Index> rows;  // of the contacts that are not open; empty if none is open
  Eigen::PartialPivLU<MatrixX> factor;
  Eigen::CompleteOrthogonalDecomposition<MatrixX> leastFactor;
  Eigen::LLT<MatrixX> shiftedFactor;
  enum class Solved { plain, least, shifted } kind = Solved::plain;

  void factorizeShifted(double shift) {
    kind = Solved::shifted;
    system = matrix;
    system.diagonal().array() += shift;
    shiftedFactor.compute(system);
  }

  void assemble(const std::vector<ContactEquation>& equations) {
    rows.clear();
    const bool isAnyOpen = std::any_of(equations.begin(), equations.end(), [](const auto& one) { return one.isOpen; });
    if (!isAnyOpen) {
      system = matrix;
    } else {
      for (std::size_t i = 0; i < equations.size(); ++i)
        for (Index axis = 0; axis < 3 && !equations[i].isOpen; ++axis) rows.push_back(3 * static_cast<Index>(i) + axis);
      system = matrix(rows, rows);
    }
    Index at = 0;
    for (const ContactEquation& equation : equations) {
      if (equation.isOpen) continue;
      system.middleRows<3>(at) = (equation.ofVelocity * system.middleRows<3>(at)).eval();
      system.block<3, 3>(at, at) += equation.ofImpulse;
      at += 3;
    }
  }

  bool factorize(const std::vector<ContactEquation>& equations) {
    kind = Solved::plain;
    assemble(equations);
    if (system.size() == 0) return true;
    factor.compute(system);
    const auto pivots = factor.matrixLU().diagonal().cwiseAbs();
    return pivots.minCoeff() > kSingularPivotRatio * pivots.maxCoeff();
  }

  void factorizeForLeast(const std::vector<ContactEquation>& equations) {
    kind = Solved::least;
    assemble(equations);
    if (system.size() == 0) return;
    leastFactor.setThreshold(kSingularPivotRatio);
    leastFactor.compute(system);
  }

  VectorX solveRows(const VectorX& sides) const {
    return kind == Solved::least ? VectorX(leastFactor.solve(sides)) : VectorX(factor.solve(sides));
  }

  VectorX solve(const VectorX& sides) const {
    if (kind == Solved::shifted) return shiftedFactor.solve(sides);
    if (system.rows() == sides.size()) return solveRows(sides);
    VectorX change = VectorX::Zero(sides.size());
    if (!rows.empty()) change(rows) = solveRows(sides(rows));
    return change;
  }
};

}  // namespace

VectorX scalesOf(const MatrixX& delassus) {
  VectorX scales(delassus.rows() / 3);
  for (Index i = 0; i < scales.size(); ++i) {
    const double inverseMass = delassus.diagonal().segment<3>(3 * i).sum() / 3;
    scales[i] = inverseMass > 0 ? 1 / std::sqrt(inverseMass) : 1;
  }
  return scales;
}

DelassusOperator operatorOf(const MatrixX& delassus) {
  DelassusOperator op;
  op.scales = scalesOf(delassus);
  const auto factors = std::make_shared<DenseFactors>();
  MatrixX& matrix = factors->matrix;
  matrix.resize(delassus.rows(), delassus.cols());
  for (Index j = 0; j < op.scales.size(); ++j)
    for (Index i = 0; i < op.scales.size(); ++i)
      matrix.block<3, 3>(3 * i, 3 * j) = op.scales[i] * op.scales[j] * delassus.block<3, 3>(3 * i, 3 * j);
  op.largest = matrix.cwiseAbs().colwise().sum().maxCoeff();
  op.minShift = kMinShiftRatio * op.largest;
  op.multiply = [factors](const VectorX& z) { return VectorX(factors->matrix * z); };
  op.magnitude = [factors](const VectorX& z) { return (factors->matrix.cwiseAbs() * z.cwiseAbs()).maxCoeff(); };
  op.factorize = [factors](const std::vector<ContactEquation>& equations) { return factors->factorize(equations); };
  op.factorizeForLeast = [factors](const std::vector<ContactEquation>& equations) {
    factors->factorizeForLeast(equations);
  };
  op.factorizeShifted = [factors](double shift) { factors->factorizeShifted(shift); };
  op.solve = [factors](const VectorX& sides, VectorX* velocities) {
    VectorX change = factors->solve(sides);
    if (velocities) *velocities = factors->matrix * change;
    return change;
  };
  return op;
}

}  // namespace cradle
