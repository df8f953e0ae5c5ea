#include "math/theta_phase.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "rounding.h"

namespace cradle {
namespace {

using std::numbers::pi;

constexpr QuarterPeriods kBelow{2, 1 - 1e-12}, kAbove{2, 1 + 1e-12};  // on either side of the change of series

double phaseOf(const ThetaPhase::Direction& direction) {
  return std::atan2(direction.imaginary, direction.real);
}

/// The series itself, with as many terms as it takes.
double phaseBySeries(const QuarterPeriods& periods, double y, double z) {
  using Complex = std::complex<long double>;
  const long double exponent = -2 * std::numbers::pi_v<long double> * periods.imaginary / periods.real;
  const Complex w(z, -std::numbers::pi_v<long double> * y / (2 * periods.real));
  Complex sum = 1;
  for (int n = 1; n < 40; ++n)
    sum += (n % 2 == 0 ? 2.0L : -2.0L) * std::exp(exponent * static_cast<long double>(n * n)) *
           std::cos(static_cast<long double>(2 * n) * w);
  return static_cast<double>(std::arg(sum));
}

TEST(ThetaPhase, MatchesTheSeriesOnBothSidesOfTheChange) {
  for (const QuarterPeriods& periods : {QuarterPeriods{1.6, 4}, kAbove, kBelow, QuarterPeriods{4, 1.6}})
    for (const double part : {0.0, 0.2, 0.7, 1.0})
      for (const double z : {-20.0, -1.5, -0.1, 0.0, 0.4, 1.2, pi / 2, 1.7, 3.0}) {
        const double y = part * periods.imaginary;
        EXPECT_NEAR(phaseOf(ThetaPhase(periods, y).at(z)), phaseBySeries(periods, y, z), 20 * kEpsilon) << part << z;
      }
}

// A central difference: error h^2 / 6 times a third derivative of 10 at most, and 1e-16 / h.
TEST(ThetaPhase, SlopeIsTheDerivativeAtZero) {
  const double h = 1e-5;
  for (const QuarterPeriods& periods : {QuarterPeriods{1.6, 4}, kAbove, kBelow, QuarterPeriods{4, 1.6}}) {
    const ThetaPhase theta(periods, 0.6 * periods.imaginary);
    EXPECT_NEAR(theta.slopeAtZero(), (phaseOf(theta.at(h)) - phaseOf(theta.at(-h))) / (2 * h), 2e-9);
  }
}

}  // namespace
}  // namespace cradle
