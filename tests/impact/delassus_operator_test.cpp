#include "impact/delassus_operator.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>
#include <random>

#include "impact/sparse_delassus.h"
#include "impact/stack_of_cubes.h"

namespace cradle {
namespace {

/// D W D with D the scales, three rows each.
MatrixX scaledBy(const VectorX& scales, const MatrixX& delassus) {
  VectorX rows(delassus.rows());
  for (Eigen::Index i = 0; i < rows.size(); ++i) rows[i] = scales[i / 3];
  return rows.asDiagonal() * delassus * rows.asDiagonal();
}

/// A stack of three cubes, light between heavy, with the operator as a dense matrix and by its factors.
struct OperatorsOfAStack {
  StackOfCubes stack{{1, 0.05, 20}};
  SparseDelassus sparse;
  MatrixX matrix;
  std::vector<DelassusOperator> all;
  std::mt19937 random{7};

  OperatorsOfAStack() {
    sparse.set(stack.contacts, stack.bodies, stack.state);
    const MatrixX delassus = sparse.matrix();
    all = {operatorOf(delassus), sparse.scaledOperator()};
    matrix = scaledBy(scalesOf(delassus), delassus);
  }
  double number() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  VectorX numbers() {
    return VectorX::NullaryExpr(matrix.rows(), [this] { return number(); });
  }
};

TEST(DelassusOperator, HasAMeanInverseMassOfOneAtEachContact) {
  OperatorsOfAStack stack;
  for (const DelassusOperator& op : stack.all)
    for (Eigen::Index i = 0; i < op.scales.size(); ++i) {
      const double scaled = op.scales[i] * op.scales[i] * stack.sparse.matrix().diagonal().segment<3>(3 * i).sum();
      EXPECT_NEAR(scaled, 3, 1e-13) << i;
    }
  EXPECT_EQ(scalesOf(MatrixX::Zero(3, 3))[0], 1);  // a contact that nothing moves
}

// Components of W z are sums of 36 terms; the magnitude is that of the terms, at least.
TEST(DelassusOperator, MultipliesAsTheMatrixDoes) {
  OperatorsOfAStack stack;
  const VectorX z = stack.numbers(), terms = stack.matrix.cwiseAbs() * z.cwiseAbs();
  for (const DelassusOperator& op : stack.all) {
    EXPECT_LT((op.multiply(z) - stack.matrix * z).cwiseAbs().maxCoeff(), 1e-14 * terms.maxCoeff());
    EXPECT_GE(op.magnitude(z), (1 - 1e-14) * terms.maxCoeff());
    EXPECT_LT(op.magnitude(z), 4 * terms.maxCoeff());
  }
  EXPECT_NEAR(stack.all[0].magnitude(z), terms.maxCoeff(), 1e-14 * terms.maxCoeff());
  const double largest = Eigen::SelfAdjointEigenSolver<MatrixX>(stack.matrix).eigenvalues().maxCoeff();
  EXPECT_GE(stack.all[0].largest, largest);
  EXPECT_LE(stack.all[0].largest, 36 * largest);
}

// A dz + B W dz = side over the contacts that are not open, by a dense matrix of all rows in which dz = 0 stands for an
// open contact. Its condition number is about 1e3 here: errors are 1e3 x 36 unit roundoffs.
TEST(DelassusOperator, SolvesEquationsOfContacts) {
  OperatorsOfAStack stack;
  for (const bool areSomeOpen : {false, true}) {
    std::vector<ContactEquation> equations(12);
    MatrixX system = MatrixX::Identity(36, 36);
    for (std::size_t i = 0; i < 12; ++i) {
      const Eigen::Index at = 3 * static_cast<Eigen::Index>(i);
      for (double& entry : equations[i].ofImpulse.reshaped()) entry = 0.2 * stack.number();
      for (double& entry : equations[i].ofVelocity.reshaped()) entry = 0.1 * stack.number();
      equations[i].ofImpulse += Mat3::Identity(), equations[i].ofVelocity += Mat3::Identity();
      equations[i].isOpen = areSomeOpen && i % 5 == 1;
      if (equations[i].isOpen) continue;
      system.middleRows<3>(at) = equations[i].ofVelocity * stack.matrix.middleRows<3>(at);
      system.block<3, 3>(at, at) += equations[i].ofImpulse;
    }
    VectorX sides = stack.numbers();
    for (Eigen::Index i = 0; i < 12; ++i)
      if (equations[static_cast<std::size_t>(i)].isOpen) sides.segment<3>(3 * i).setZero();
    const VectorX expected = system.fullPivLu().solve(sides);
    for (const DelassusOperator& op : stack.all) {
      EXPECT_TRUE(op.factorize(equations));
      VectorX velocities;
      const VectorX change = op.solve(sides, &velocities);
      EXPECT_LT((change - expected).norm(), 1e-11 * expected.norm());
      EXPECT_LT((velocities - stack.matrix * expected).norm(), 1e-11 * expected.norm());
      EXPECT_EQ(op.solve(sides, nullptr), change);
    }
  }
}

TEST(DelassusOperator, SolvesShiftedSystems) {
  OperatorsOfAStack stack;
  const VectorX sides = stack.numbers();
  for (const double shift : {0.01, 2.0})
    for (const DelassusOperator& op : stack.all) {
      EXPECT_LE(op.minShift, 1e-5);
      op.factorizeShifted(shift);
      VectorX velocities;
      const VectorX change = op.solve(sides, &velocities);
      // Divided by the shift, as rounding is.
      const double tolerance = 1e-12 * sides.norm() / shift;
      EXPECT_LT((shift * change + stack.matrix * change - sides).norm(), tolerance);
      EXPECT_LT((velocities - stack.matrix * change).norm(), tolerance);
    }
}

// Four contacts on a cube's face have twelve rows for six freedoms: W dz = u has many solutions, which the operator
// says. That of least norm is the pseudo-inverse's.
TEST(DelassusOperator, FindsTheSolutionOfLeastNormWhereThereAreMany) {
  StackOfCubes cube({2});
  SparseDelassus sparse;
  sparse.set(cube.contacts, cube.bodies, cube.state);
  const DelassusOperator op = operatorOf(sparse.matrix());
  ContactEquation stops;
  stops.ofImpulse.setZero();
  ContactEquation open;
  open.isOpen = true;
  const VectorX sides = op.multiply(VectorX::LinSpaced(12, -1, 2));
  const std::vector<ContactEquation> all(4, stops);
  EXPECT_FALSE(op.factorize(all));
  op.factorizeForLeast(all);
  const VectorX least = op.solve(sides, nullptr);
  const MatrixX matrix = scaledBy(op.scales, sparse.matrix());
  const VectorX expected = matrix.completeOrthogonalDecomposition().pseudoInverse() * sides;
  EXPECT_LT((least - expected).norm(), 1e-12 * expected.norm());
  EXPECT_TRUE(op.factorize({stops, open, open, open}));  // a single point is not redundant
  const VectorX single = op.solve(sides, nullptr);
  EXPECT_TRUE(single.tail(9).isZero(0));
  EXPECT_LT((matrix.topLeftCorner(3, 3) * single.head(3) - sides.head(3)).norm(), 1e-13 * sides.norm());
}

}  // namespace
}  // namespace cradle
