#include "math/elementary.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "math/angle_reduction.h"

// Only operations that IEEE 754 rounds exactly: + - * / and floor. Each function maps its argument to a short interval
// around 0 and sums a Taylor series there, so that the coefficients need no table: they are written as what they are.
// Largest errors found: sin 0.79, cos 0.81, exp 0.77, log 0.86 units in the last place.

namespace cradle {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kLn2High = 0x1.62e42feep-1,
                 kLn2Low = 0x1.a39ef35793c76p-33;  // ln 2; 32 bits, so that small multiples are exact, and the rest

constexpr double inverseFactorial(int n) {
  double factorial = 1;  // exact up to 22!
  for (int i = 2; i <= n; ++i) factorial *= i;
  return 1 / factorial;
}

/// Coefficients sign^i / (first + step i)! of a Taylor series.
template <std::size_t kTerms>
constexpr std::array<double, kTerms> factorialSeries(int first, int step, double sign) {
  std::array<double, kTerms> series{};
  double factor = 1;
  for (std::size_t i = 0; i < kTerms; ++i, factor *= sign)
    series[i] = factor * inverseFactorial(first + step * static_cast<int>(i));
  return series;
}

/// Coefficients 2 / (2 i + 3): ln((1 + s) / (1 - s)) = 2 s + 2/3 s^3 + 2/5 s^5 + ...
template <std::size_t kTerms>
constexpr std::array<double, kTerms> logarithmSeries() {
  std::array<double, kTerms> series{};
  for (std::size_t i = 0; i < kTerms; ++i) series[i] = 2.0 / static_cast<double>(2 * i + 3);
  return series;
}

template <std::size_t kTerms>
double polynomial(const std::array<double, kTerms>& coefficients, double x) {
  double sum = coefficients[kTerms - 1];
  for (std::size_t i = kTerms - 1; i-- > 0;) sum = sum * x + coefficients[i];
  return sum;
}

// Up to x^19/19! and x^18/18!: the next terms are below 2^-68 for |x| <= pi/4.
double sinNearZero(double x, double tail) {
  static constexpr auto kSeries = factorialSeries<9>(3, 2, -1);
  if (x == 0) return x;  // with its sign
  const double square = x * x;
  return x + (tail * (1 - square / 2) - x * square * polynomial(kSeries, square));
}
double cosNearZero(double x, double tail) {
  static constexpr auto kSeries = factorialSeries<8>(4, 2, -1);
  const double square = x * x, half = square / 2, leading = 1 - half;
  return leading + (((1 - leading) - half) + (square * square * polynomial(kSeries, square) - x * tail));
}

/// Of 0..1. Two halvings of the angle, atan x = pi/4 + atan((x - 1)/(x + 1)) and atan x = 2 atan(x/(1 + sqrt(1 +
/// x^2))), lead to 0.2 at the most, where the series x - x^3/3 + x^5/5 - ... is summed up to x^25: the next term is
/// below 2^-66.
double arctangent(double x) {
  constexpr double kQuarterPi = 0x1.921fb54442d18p-1, kTanEighthPi = 0.41421356237309503;
  const bool isSteep = x > kTanEighthPi;
  if (isSteep) x = (x - 1) / (x + 1);
  const double u = x / (1 + std::sqrt(1 + x * x)), square = u * u;
  double sum = 0;
  for (int i = 12; i > 0; --i) sum = square * ((i % 2 == 0 ? 1.0 : -1.0) / (2 * i + 1) + sum);
  const double angle = 2 * (u + u * sum);
  return isSteep ? kQuarterPi + angle : angle;
}

double powerOfTwo(int exponent) {  // -1022 to 1023
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

}  // namespace

SinCos sinCos(double angle) {
  if (!(std::fabs(angle) < kInfinity)) return {kNaN, kNaN};
  const ReducedAngle reduced = reduceAngle(angle);
  const double sine = sinNearZero(reduced.remainder, reduced.tail);
  const double cosine = cosNearZero(reduced.remainder, reduced.tail);
  switch (reduced.quarterTurns) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

double sin(double angle) {
  return sinCos(angle).sin;
}

double cos(double angle) {
  return sinCos(angle).cos;
}

double atan2(double sin, double cos) {
  constexpr double kHalfPi = 0x1.921fb54442d18p0, kPi = 0x1.921fb54442d18p1;
  const double y = std::fabs(sin), x = std::fabs(cos);
  if (y == 0 && x == 0) return 0;
  double angle = y > x ? kHalfPi - arctangent(x / y) : arctangent(y / x);
  if (cos < 0) angle = kPi - angle;
  return sin < 0 ? -angle : angle;
}

double exp(double x) {
  if (x != x) return kNaN;
  if (x > 709.8) return kInfinity;  // above ln(2^1024)
  if (x < -745.2) return 0;         // below ln(2^-1075)
  constexpr double kInverseLn2 = 1.4426950408889634;
  const double multiple = std::floor(x * kInverseLn2 + 0.5);
  const double high = x - multiple * kLn2High, low = multiple * kLn2Low;
  const double r = high - low, rest = (high - r) - low;
  // Up to r^14/14!: the next term is below 2^-63 for |r| <= ln(2)/2.
  static constexpr auto kSeries = factorialSeries<13>(2, 1, 1);
  const double tail = rest + r * r * polynomial(kSeries, r);
  const double sum = 1 + r, lost = r - (sum - 1);
  // In two steps, for the first is exact where the result is subnormal.
  const int exponent = static_cast<int>(multiple), firstStep = exponent / 2;
  return (sum + (lost + tail)) * powerOfTwo(firstStep) * powerOfTwo(exponent - firstStep);
}

double log(double x) {
  if (!(x > 0)) return x == 0 ? -kInfinity : kNaN;
  if (x == kInfinity) return kInfinity;
  const bool isSubnormal = x < std::numeric_limits<double>::min();
  const auto bits = std::bit_cast<std::uint64_t>(isSubnormal ? x * 0x1p54 : x);
  // x = 2^exponent m, m from sqrt(1/2) to sqrt(2), so that nothing cancels near x = 1.
  constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcc, kMantissaMask = (std::uint64_t{1} << 52) - 1;
  const std::uint64_t shifted = bits - kSqrtHalf;
  const int exponent = static_cast<int>(static_cast<std::int64_t>(shifted) >> 52) - (isSubnormal ? 54 : 0);
  const double m = std::bit_cast<double>((shifted & kMantissaMask) + kSqrtHalf);
  // f - f^2/2 + s (f^2/2 + 2/3 s^2 + 2/5 s^4 + ...), which is 2 s + 2/3 s^3 + ..., has all but its first term small. Up
  // to s^23: the next term is below 2^-63 of s, for s <= 0.172.
  static constexpr auto kSeries = logarithmSeries<11>();
  const double f = m - 1, s = f / (2 + f), square = s * s, half = f * f / 2;
  const double tail = s * (half + square * polynomial(kSeries, square)) + exponent * kLn2Low;
  return exponent * kLn2High - ((half - tail) - f);
}

}  // namespace cradle
