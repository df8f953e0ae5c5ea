#include "math/running_integral.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

/// x^n from -1 to x is (x^(n+1) - (-1)^(n+1)) / (n + 1): exactly up to degree 10, and not beyond.
TEST(RunningIntegral, IsExactUpToDegreeTen) {
  for (int degree = 0; degree <= 11; ++degree) {
    int count = 0;
    const auto power = [&](double x) { return ++count, VectorX::Constant(1, std::pow(x, degree)); };
    const RunningIntegral integral(power, -1, 2, INFINITY);
    EXPECT_EQ(count, 11);
    double largest = 0;
    for (const double x : {-1.0, -0.9, 0.2, 1.4, 2.0}) {
      const double exact = (std::pow(x, degree + 1) - std::pow(-1, degree + 1)) / (degree + 1);
      largest = std::max(largest, std::abs(integral.upTo(x)[0] - exact));
    }
    const double whole = std::pow(2, degree + 1) / (degree + 1);
    if (degree <= 10)
      EXPECT_LT(largest, 1e-13 * whole) << degree;
    else
      EXPECT_GT(largest, 1e-7 * whole);
  }
}

/// The circle's quarter, whose slope is infinite at its end, and a kink, within the tolerance at each place; each
/// component counts, and what is smooth takes eleven evaluations.
TEST(RunningIntegral, HalvesUntilItsLastCoefficientsAreSmall) {
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6}) {
    int count = 0;
    const auto both = [&](double x) { return ++count, Eigen::Vector2d(std::abs(x - 0.3), std::sqrt(1 - x * x)); };
    const RunningIntegral integral(both, 0, 1, tolerance);
    EXPECT_GT(count, 11);
    for (int i = 0; i <= 40; ++i) {
      const double x = i / 40.0;
      EXPECT_NEAR(integral.upTo(x)[0], (0.09 + (x - 0.3) * std::abs(x - 0.3)) / 2, tolerance) << x;
      EXPECT_NEAR(integral.upTo(x)[1], (x * std::sqrt(1 - x * x) + std::asin(x)) / 2, tolerance) << x;
    }
  }
  int count = 0;
  const auto sine = [&](double x) { return ++count, VectorX::Constant(1, std::sin(x)); };
  EXPECT_NEAR(RunningIntegral(sine, 0, 1, 1e-9).upTo(0.7)[0], 1 - std::cos(0.7), 1e-9);
  EXPECT_EQ(count, 11);
}

/// No tolerance is asked of rounding: a sum of 1e16 is known to some units.
TEST(RunningIntegral, DoesNotHalveForRounding) {
  int count = 0;
  const auto large = [&](double x) { return ++count, VectorX::Constant(1, 1e16 * (1 + x * x)); };
  const RunningIntegral integral(large, 0, 1, 1e-20);
  EXPECT_EQ(count, 11);
  EXPECT_NEAR(integral.upTo(0.5)[0], 1e16 * (0.5 + 0.125 / 3), 20);
}

}  // namespace
}  // namespace cradle
