#include "impact/lorentz_cone.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

constexpr double kLorentzRounding = 1e-13;  // of some tens of operations on numbers below 10

const Vec3 kInsideX(0.3, -0.5, 1.2), kInsideY(-0.7, 0.2, 0.9);

// In a plane through the axis the product is that of pairs n + t and n - t, of which the determinant is the product.
TEST(LorentzCone, MultipliesPairsInAPlaneThroughTheAxis) {
  const auto pairOf = [](double plus, double minus) {
    return Vec3((plus - minus) / 2 * 0.6, (plus - minus) / 2 * 0.8, (plus + minus) / 2);
  };
  EXPECT_LT((coneProduct(pairOf(2, 3), pairOf(5, 0.5)) - pairOf(10, 1.5)).norm(), kLorentzRounding);
  EXPECT_LT((coneQuotient(pairOf(10, 1.5), pairOf(2, 3)) - pairOf(5, 0.5)).norm(), kLorentzRounding);
  EXPECT_NEAR(coneDeterminant(pairOf(2, 3)), 6, kLorentzRounding);
}

TEST(LorentzCone, DividesWhatItMultiplied) {
  const Vec3 any(2, -3, 0.4);
  EXPECT_LT((coneQuotient(coneProduct(kInsideX, any), kInsideX) - any).norm(), kLorentzRounding);
  EXPECT_LT((coneProduct(kInsideY, coneQuotient(any, kInsideY)) - any).norm(), kLorentzRounding);
}

// W is symmetric and positive, takes y where its inverse takes x, and keeps the cone: the determinants of all vectors
// are scaled by one factor.
TEST(ConeScaling, TakesBothPointsToOne) {
  const auto [scale, inverse] = coneScaling(kInsideX, kInsideY);
  EXPECT_LT((scale * kInsideY - inverse * kInsideX).norm(), kLorentzRounding);
  EXPECT_LT((scale * inverse - Mat3::Identity()).norm(), kLorentzRounding);
  EXPECT_LT((scale - scale.transpose()).norm(), kLorentzRounding);
  const double factor = coneDeterminant(scale * kInsideX) / coneDeterminant(kInsideX);
  for (const Vec3& any : {kInsideY, Vec3(2, -3, 0.4), Vec3(0, 0, 1)})
    EXPECT_NEAR(coneDeterminant(scale * any), factor * coneDeterminant(any), 10 * kLorentzRounding);
  EXPECT_GT((scale * Vec3::UnitZ()).z(), 0);
}

// Where the step ends, the point is on the cone's side, and before that it is inside.
TEST(ConeStep, EndsOnTheSideOfTheCone) {
  for (const Vec3& way : {Vec3(1, 0, 0), Vec3(0.2, -0.9, 0.3), Vec3(0, 0, -1), Vec3(0.5, 0.5, -3)}) {
    const double step = stepToBoundary(kInsideX, way);
    ASSERT_TRUE(std::isfinite(step));
    EXPECT_GT(step, 0);
    const Vec3 end = kInsideX + step * way;
    EXPECT_NEAR(end.head<2>().norm(), end.z(), kLorentzRounding);
    const Vec3 before = kInsideX + 0.999 * step * way;
    EXPECT_LT(before.head<2>().norm(), before.z());
  }
}

// A way that is in the cone itself never leaves it.
TEST(ConeStep, IsInfiniteAlongTheCone) {
  for (const Vec3& way : {Vec3(0, 0, 1), Vec3(0.6, 0.7, 1)})
    EXPECT_EQ(stepToBoundary(kInsideX, way), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace cradle
