#include "math/jacobi_elliptic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "rounding.h"

namespace cradle {
namespace {

using std::numbers::pi;

// K for k^2 = 1/2 is Gamma(1/4)^2 / (4 sqrt(pi)); next to k = 1 it is ln(4 / k'), up to k'^2 ln(4 / k') / 4.
TEST(JacobiElliptic, QuarterPeriodMatchesClosedForms) {
  EXPECT_NEAR(JacobiElliptic(1).quarterPeriod(), pi / 2, kEpsilon);
  EXPECT_NEAR(JacobiElliptic(std::numbers::sqrt2 / 2).quarterPeriod(), 1.85407467730137191843, 2 * kEpsilon);
  for (const double complement : {1e-9, 1e-50, 1e-145}) {
    const double expected = std::log(4 / complement);
    EXPECT_NEAR(JacobiElliptic(complement).quarterPeriod(), expected, 8 * kEpsilon * expected);
  }
}

// sn(K/2) = 1 / sqrt(1 + k'), cn(K/2) = sqrt(k' / (1 + k')), dn(K/2) = sqrt(k'). An error of the argument, K/2 times a
// few roundings, is one of the same relative size of cn and dn.
TEST(JacobiElliptic, HalfOfTheQuarterPeriodMatchesClosedForms) {
  for (const double k : {1.0, 0.999999, 0.7, 0.1, 1e-3, 1e-8, 1e-20, 1e-80, 1e-145}) {
    const JacobiElliptic elliptic(k);
    const double tolerance = 4 * kEpsilon * (1 + elliptic.quarterPeriod());
    for (const double quarter : {0.0, pi / 2, pi, 3 * pi / 2}) {
      const JacobiElliptic::Values values = elliptic.at(sinCos(quarter + pi / 4));
      EXPECT_NEAR(std::fabs(values.sn), 1 / std::sqrt(1 + k), tolerance);
      EXPECT_NEAR(std::fabs(values.cn) / std::sqrt(k / (1 + k)), 1, tolerance);
      EXPECT_NEAR(values.dn / std::sqrt(k), 1, tolerance);
      EXPECT_EQ(values.sn > 0, quarter < 2);
      EXPECT_EQ(values.cn > 0, quarter < 1 || quarter > 4);
    }
  }
}

TEST(JacobiElliptic, WithoutModulusItIsSineAndCosine) {
  for (const double phase : {-4.0, -0.3, 0.0, 1e-150, 1e-320, 0.7, 3.0}) {
    const JacobiElliptic::Values values = JacobiElliptic(1).at(sinCos(phase));
    EXPECT_NEAR(values.sn, std::sin(phase), kEpsilon);
    EXPECT_NEAR(values.cn, std::cos(phase), kEpsilon);
    EXPECT_NEAR(values.dn, 1, kEpsilon);
  }
}

TEST(JacobiElliptic, ArgumentIsTheInverse) {
  for (const double k : {1.0, 0.7, 0.01, 1e-8, 1e-60, 1e-145}) {
    const JacobiElliptic elliptic(k);
    for (const double part : {-1.0, -0.9, -0.3, 0.0, 1e-30, 0.1, 0.5, 0.99, 1.0}) {
      const double u = ellipticArgument(elliptic.at(sinCos(part * pi / 2)));
      EXPECT_NEAR(u, part * elliptic.quarterPeriod(), 8 * kEpsilon * elliptic.quarterPeriod()) << k << ' ' << part;
    }
  }
}

}  // namespace
}  // namespace cradle
