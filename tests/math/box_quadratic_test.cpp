#include "math/box_quadratic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cradle {
namespace {

/// Whether x is the minimum: inside, the gradient is zero; at a limit, it points outwards.
void expectMinimum(const MatrixX& A, const VectorX& b, const VectorX& limits, const VectorX& x, double tolerance) {
  const VectorX gradient = A * x - b;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    EXPECT_LE(std::abs(x[i]), limits[i] * (1 + 1e-12));
    const bool isAtMost = x[i] >= limits[i], isAtLeast = x[i] <= -limits[i];
    if (!isAtMost) {
      EXPECT_GE(gradient[i], -tolerance) << i;
    }
    if (!isAtLeast) {
      EXPECT_LE(gradient[i], tolerance) << i;
    }
  }
}

TEST(BoxMinimum, HoldsItsConditions) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (const Eigen::Index size : {1, 2, 5, 20})
    for (int trial = 0; trial < 50; ++trial) {
      const MatrixX root = MatrixX::NullaryExpr(size, size, [&] { return normal(random); });
      const MatrixX A = root * root.transpose() + 0.01 * MatrixX::Identity(size, size);
      const VectorX b = VectorX::NullaryExpr(size, [&] { return 3 * normal(random); });
      const VectorX limits = VectorX::NullaryExpr(size, [&] { return std::abs(normal(random)); });
      expectMinimum(A, b, limits, boxMinimum(A, b, limits, 0), 1e-9 * b.norm() * A.norm());
    }
}

/// Friction of contacts that slide leaves motors matrices that are not definite. Their conditions have several
/// solutions, and no minimum inside.
TEST(BoxMinimum, HoldsItsConditionsWhereCurvatureIsNegative) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (const Eigen::Index size : {1, 2, 5})
    for (int trial = 0; trial < 50; ++trial) {
      const MatrixX any = MatrixX::NullaryExpr(size, size, [&] { return normal(random); });
      const MatrixX A = any + any.transpose();
      const VectorX b = VectorX::NullaryExpr(size, [&] { return 3 * normal(random); });
      const VectorX limits = VectorX::NullaryExpr(size, [&] { return std::abs(normal(random)); });
      expectMinimum(A, b, limits, boxMinimum(A, b, limits, 0), 1e-9 * b.norm() * A.norm());
    }
}

/// Of four that share one load, each a quarter; if one has less, the others a third of the rest.
TEST(BoxMinimum, SharesWhatIsNotDetermined) {
  const MatrixX A = MatrixX::Ones(4, 4);
  const VectorX b = VectorX::Constant(4, 8);
  EXPECT_LT((boxMinimum(A, b, VectorX::Constant(4, 9), 0) - VectorX::Constant(4, 2)).norm(), 1e-12);
  EXPECT_LT((boxMinimum(A, b, Eigen::Vector4d(9, 9, 0.5, 9), 0) - Eigen::Vector4d(2.5, 2.5, 0.5, 2.5)).norm(), 1e-12);
  EXPECT_LT((boxMinimum(A, b, VectorX::Constant(4, 1), 0) - VectorX::Constant(4, 1)).norm(), 1e-12);
}

/// Two of four that share one load are to give more of the sum than the others, which no share does: they give all they
/// have, and the others share what is left. A contradiction by rounding is none.
TEST(BoxMinimum, OfAContradictionIsAtItsLimits) {
  const MatrixX A = 0.7 * MatrixX::Ones(4, 4);
  const auto asking = [](double more) { return Eigen::Vector4d(1.4 + more, 1.4, 1.4 + more, 1.4); };
  for (const double more : {1e-3, 0.1}) {
    // The sum of all four that those hold who are within their limits is what they ask over 0.7.
    const VectorX first = boxMinimum(A, asking(more), VectorX::Constant(4, 3), 1e-6);
    EXPECT_LT((first - Eigen::Vector4d(3, -2, 3, -2)).norm(), 1e-9) << more;
    const double rest = (1.4 - more) / 0.7 / 2 - 3;
    const VectorX second = boxMinimum(A, asking(-more), VectorX::Constant(4, 3), 1e-6);
    EXPECT_LT((second - Eigen::Vector4d(rest, 3, rest, 3)).norm(), 1e-9) << more;
  }
  EXPECT_LT((boxMinimum(A, asking(1e-7), VectorX::Constant(4, 3), 1e-6) - VectorX::Constant(4, 0.5)).norm(), 1e-6);
}

/// What nothing moves has nothing to do.
TEST(BoxMinimum, OfNothingIsNothing) {
  EXPECT_EQ(boxMinimum(MatrixX::Zero(2, 2), Eigen::Vector2d(0, 0), Eigen::Vector2d(3, 3), 0).norm(), 0);
}

}  // namespace
}  // namespace cradle
