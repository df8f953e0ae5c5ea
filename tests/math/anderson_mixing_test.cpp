#include <gtest/gtest.h>

#include <Eigen/LU>

#include "math/anderson_mixing.h"

namespace cradle {
namespace {

/// x_(k+1) = A x_k + b, from zero.
int roundsTo(double error, const MatrixX& a, const VectorX& b, VectorX& x) {
  AndersonMixing mixing;
  const VectorX solution = (MatrixX::Identity(b.size(), b.size()) - a).partialPivLu().solve(b);
  x = VectorX::Zero(b.size());
  for (int round = 0; round < 100; ++round) {
    if ((x - solution).norm() <= error * solution.norm()) return round;
    x = mixing.next(x, a * x + b);
  }
  return 100;
}

// Of a linear map of n numbers the fixed point is known from n + 1 values: also where rounds alone come nearer by a
// thousandth each, or go away (largest eigenvalues 0.999 and -3). Rounding grows by 1 / |1 - eigenvalue|.
TEST(AndersonMixing, FindsTheFixedPointOfALinearMap) {
  VectorX x;
  EXPECT_LE(roundsTo(1e-10, MatrixX::Constant(1, 1, 0.999), VectorX::Constant(1, 2.0), x), 2);
  EXPECT_NEAR(x[0], 2000, 2e-7);
  const MatrixX swap = (MatrixX(3, 3) << 0.5, 1, 0, 0, -3, 2, 1, 0, 0.9).finished();
  EXPECT_LE(roundsTo(1e-10, swap, Vec3(1, -2, 0.5), x), 4);
}

// Two rounds of the first kind with one that is cut off at zero, as forces are: near the end it is linear.
TEST(AndersonMixing, FindsTheFixedPointOfAMapWithACorner) {
  AndersonMixing mixing;
  VectorX x = VectorX::Zero(2);
  const auto map = [](const VectorX& at) {
    return VectorX(Eigen::Vector2d(1 + 0.98 * at[0] - 0.1 * at[1], -3 + 0.2 * at[0]).cwiseMax(0));
  };
  int round = 0;
  for (; round < 50 && (map(x) - x).norm() > 1e-12; ++round) x = mixing.next(x, map(x)).cwiseMax(0);
  // x1 = -3 + 0.2 x0, 0.02 x0 = 1 - 0.1 x1 = 1.3 - 0.02 x0
  EXPECT_NEAR(x[0], 32.5, 1e-9);
  EXPECT_NEAR(x[1], 3.5, 1e-9);
  EXPECT_LT(round, 20);
}

// A map that moves all by the same has no fixed point: nothing is known of one, and the next is the image.
TEST(AndersonMixing, GoesOnWithTheImageWhereNothingChanges) {
  AndersonMixing mixing;
  VectorX x = Eigen::Vector2d(1, 2);
  const VectorX step = Eigen::Vector2d(0.5, -0.25);
  for (int round = 0; round < 12; ++round) {
    const VectorX image = x + step;
    EXPECT_EQ(mixing.next(x, image), image) << round;
    if (round % 2 == 0) x = image;
  }
}

}  // namespace
}  // namespace cradle
