#include "math/elementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

// The oracle is the C library's functions of long double, which have 64 bits of mantissa on x86: 11 more than needed.

namespace cradle {
namespace {

static_assert(std::numeric_limits<long double>::digits == 64);

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMin = std::numeric_limits<double>::denorm_min(), kMax = std::numeric_limits<double>::max();
constexpr double kMinNormal = std::numeric_limits<double>::min();

/// Distance of two numbers in units of the last place of `exact`, rounded to double.
double ulps(double value, long double exact) {
  if (value == static_cast<double>(exact)) return 0;
  const double size = std::max(std::fabs(static_cast<double>(exact)), kMinNormal);
  const int exponent = std::ilogb(std::min(size, kMax));
  return static_cast<double>(std::fabs(value - exact) / std::ldexp(1.0L, exponent - 52));
}

using Function = double(double);
using Oracle = long double(long double);

void expectBelowOneUlp(Function* function, Oracle* oracle, const std::vector<double>& arguments) {
  double worst = 0, at = 0;
  for (const double x : arguments) {
    const double error = ulps(function(x), oracle(x));
    if (!(error <= worst)) worst = error, at = x;
  }
  EXPECT_LT(worst, 1) << std::hexfloat << at;
}

std::vector<double> uniform(double low, double high, int count) {
  std::mt19937_64 random(1);
  std::vector<double> values;
  for (int i = 0; i < count; ++i)
    values.push_back(low + (high - low) * (static_cast<double>(random() >> 11) * 0x1p-53));
  return values;
}

/// Of all sizes from the least subnormal to the greatest double.
std::vector<double> ofAllSizes(int count) {
  std::mt19937_64 random(2);
  std::vector<double> values{kMin, 3 * kMin, kMinNormal, std::nextafter(kMinNormal, 0), kMax};
  while (static_cast<int>(values.size()) < count) {
    const double x = std::bit_cast<double>(static_cast<std::uint64_t>(random()) >> 1);
    if (std::isfinite(x)) values.push_back(x);
  }
  return values;
}

std::vector<double> negative(std::vector<double> values) {
  for (double& value : values) value = -value;
  return values;
}

/// The doubles around multiples of pi/4, and the one that comes closest of all to a multiple of pi/2.
std::vector<double> hardAngles() {
  std::vector<double> angles{6381956970095103 * 0x1p797, 1e22, 1e6, -1e22, 0x1p1023};
  constexpr long double kQuarterPi = std::numbers::pi_v<long double> / 4;
  for (int i = 1; i < 60000; ++i) {
    const auto angle = static_cast<double>(static_cast<long double>(i) * kQuarterPi);
    angles.insert(angles.end(), {std::nextafter(angle, 0), angle, -std::nextafter(angle, kInfinity)});
  }
  return angles;
}

void expectSineAndCosine(const std::vector<double>& angles) {
  expectBelowOneUlp(sin, std::sin, angles);
  expectBelowOneUlp(cos, std::cos, angles);
}

TEST(Elementary, SineAndCosineErrBelowOneUlp) {
  expectSineAndCosine(uniform(-1, 1, 200000));
  expectSineAndCosine(uniform(-20, 20, 200000));
  expectSineAndCosine(uniform(-1e6, 1e6, 200000));
}

TEST(Elementary, SineAndCosineOfAnglesOfAnySizeErrBelowOneUlp) {
  expectSineAndCosine(ofAllSizes(200000));
  expectSineAndCosine(negative(ofAllSizes(10000)));
}

TEST(Elementary, SineAndCosineNextToQuarterTurnsErrBelowOneUlp) {
  expectSineAndCosine(hardAngles());
}

// The digits are those of K. Ng, "Argument reduction for huge arguments: good to the last bit", 1992.
TEST(Elementary, SineOfTenToThePowerOfTwentyTwo) {
  EXPECT_EQ(sin(1e22), -0.8522008497671888017727);
}

TEST(Elementary, SineAndCosineTogetherHaveTheSameBits) {
  for (const double angle : uniform(-100, 100, 1000)) {
    EXPECT_EQ(sinCos(angle).sin, sin(angle));
    EXPECT_EQ(sinCos(angle).cos, cos(angle));
  }
}

TEST(Elementary, ExponentialErrsBelowOneUlp) {
  expectBelowOneUlp(exp, std::exp, uniform(-1, 1, 200000));
  expectBelowOneUlp(exp, std::exp, uniform(-708, 709.7, 200000));
  expectBelowOneUlp(exp, std::exp, {1e-300, -1e-300, kMin, 709.782712893384, 1e-17, -1e-17});
}

TEST(Elementary, SubnormalExponentialErrsBelowOneUlp) {
  expectBelowOneUlp(exp, std::exp, uniform(-745.2, -708, 200000));
}

TEST(Elementary, LogarithmErrsBelowOneUlp) {
  expectBelowOneUlp(log, std::log, uniform(0.5, 2, 200000));
  expectBelowOneUlp(log, std::log, uniform(0.999, 1.001, 200000));
  expectBelowOneUlp(log, std::log, ofAllSizes(200000));
  expectBelowOneUlp(log, std::log, {std::nextafter(1, 0), std::nextafter(1, 2), std::numbers::sqrt2 / 2});
}

TEST(Elementary, AngleOfADirectionErrsBelowFourUlps) {
  double worst = 0;
  const std::vector<double> first = uniform(-1, 1, 100000), sizes = ofAllSizes(100000);
  for (std::size_t i = 1; i < first.size(); ++i)
    for (const auto& [y, x] : {std::pair(first[i], first[i - 1]), {first[i], 1.0}, {1.0, first[i]}, {sizes[i], -1.0}})
      worst = std::max(worst, ulps(atan2(y, x), std::atan2(static_cast<long double>(y), static_cast<long double>(x))));
  EXPECT_LT(worst, 4);
  EXPECT_EQ(atan2(0, 0), 0);
  EXPECT_EQ(atan2(0, 1), 0);
  EXPECT_EQ(atan2(0, -1), std::numbers::pi);
  EXPECT_EQ(atan2(-2, 0), -std::numbers::pi / 2);
}

TEST(Elementary, SpecialValuesAreThoseOfIeee754) {
  EXPECT_TRUE(std::signbit(sin(-0.0)));
  EXPECT_FALSE(std::signbit(sin(0.0)));
  EXPECT_EQ(cos(-0.0), 1);
  for (const double x : {kNaN, kInfinity, -kInfinity}) {
    EXPECT_TRUE(std::isnan(sin(x)));
    EXPECT_TRUE(std::isnan(cos(x)));
  }
  EXPECT_EQ(exp(0), 1);
  EXPECT_EQ(exp(kInfinity), kInfinity);
  EXPECT_EQ(exp(-kInfinity), 0);
  EXPECT_EQ(exp(709.79), kInfinity);
  EXPECT_EQ(exp(kMax), kInfinity);
  EXPECT_EQ(exp(-745.14), 0);
  EXPECT_TRUE(std::isnan(exp(kNaN)));
  EXPECT_EQ(log(1), 0);
  EXPECT_EQ(log(0), -kInfinity);
  EXPECT_EQ(log(-0.0), -kInfinity);
  EXPECT_EQ(log(kInfinity), kInfinity);
  for (const double x : {-1.0, -kInfinity, kNaN}) EXPECT_TRUE(std::isnan(log(x)));
}

// 64-bit FNV-1a over the bits of results. The value must not change with compiler, processor or optimisation; a change
// of the functions changes it, and every golden state of the program with it.
TEST(Elementary, ResultsHaveTheSameBitsEverywhere) {
  std::uint64_t hash = 0xcbf29ce484222325;
  const auto add = [&](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 8) hash = (hash ^ (bits >> shift & 0xff)) * 0x100000001b3;
  };
  for (const auto& angles : {uniform(-10, 10, 20000), ofAllSizes(20000), hardAngles()})
    for (const double angle : angles) add(sin(angle)), add(cos(angle));
  for (const double x : uniform(-745, 709, 20000)) add(exp(x));
  for (const double x : ofAllSizes(20000)) add(log(x));
  EXPECT_EQ(hash, 0x262b42799d8b2d6au);
}

}  // namespace
}  // namespace cradle
