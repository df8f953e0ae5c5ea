#include "math/gauss_legendre.h"

#include <gtest/gtest.h>

#include <cmath>

namespace cradle {
namespace {

/// x^n from -1 to 2 is (2^(n+1) - (-1)^(n+1)) / (n + 1): exactly up to degree 11, and not beyond.
TEST(GaussLegendre, IsExactUpToDegreeEleven) {
  for (int degree = 0; degree <= 12; ++degree) {
    int count = 0;
    const auto power = [&](double x) { return ++count, VectorX::Constant(1, std::pow(x, degree)); };
    const double sum = integralOf(power, -1, 2, INFINITY)[0];
    const double exact = (std::pow(2, degree + 1) - std::pow(-1, degree + 1)) / (degree + 1);
    EXPECT_EQ(count, 6);
    if (degree <= 11)
      EXPECT_NEAR(sum, exact, 1e-13 * std::abs(exact)) << degree;
    else
      EXPECT_GT(std::abs(sum - exact), 1e-9 * exact);
  }
}

/// The circle's quarter, whose slope is infinite at its end, and a kink; each component counts.
TEST(GaussLegendre, HalvesUntilBothAgree) {
  for (const double tolerance : {1e-3, 1e-5, 1e-6}) {
    const auto both = [](double x) { return Eigen::Vector2d(1, std::sqrt(1 - x * x)); };
    EXPECT_NEAR(integralOf(both, 0, 1, tolerance)[1], M_PI / 4, tolerance);
    const auto kink = [](double x) { return Eigen::Vector2d(std::abs(x - 0.3), 0); };
    EXPECT_NEAR(integralOf(kink, 0, 1, tolerance)[0], (0.09 + 0.49) / 2, tolerance);
  }
}

/// What another way has found saves the halves if it is near, and changes nothing if it is not.
TEST(GaussLegendre, IsSatisfiedByWhatIsKnown) {
  int count = 0;
  const auto sine = [&](double x) { return ++count, VectorX::Constant(1, std::sin(x)); };
  EXPECT_NEAR(integralOf(sine, 0, 1, 1e-9, VectorX::Constant(1, 1 - std::cos(1.0)))[0], 1 - std::cos(1.0), 1e-9);
  EXPECT_EQ(count, 6);
  EXPECT_NEAR(integralOf(sine, 0, 1, 1e-9, VectorX::Constant(1, 7))[0], 1 - std::cos(1.0), 1e-9);
  EXPECT_EQ(count, 24);
}

}  // namespace
}  // namespace cradle
