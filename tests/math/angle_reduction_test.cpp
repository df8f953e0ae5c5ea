#include "math/angle_reduction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

// The oracle is the C library's sine and cosine of long double, which reduce angles of any size by themselves.

namespace cradle {
namespace {

static_assert(std::numeric_limits<long double>::digits == 64);

/// The rest (rad) of an angle less those quarter turns: of sin r, which is one of +-sin, +-cos of the angle.
long double restOf(double angle, int quarterTurns) {
  const long double exact = angle;
  const long double sines[] = {std::sin(exact), -std::cos(exact), -std::sin(exact), std::cos(exact)};
  return std::asin(sines[quarterTurns]);
}

/// Within pi/4 of 0, quarter turns and rest add up to the angle, with a tail that is no more than the remainder's
/// rounding. The oracle has an error of two roundings of 2^-64 (and the sine's slope is at least 0.7).
void expectReduced(double angle) {
  const ReducedAngle reduced = reduceAngle(angle);
  ASSERT_GE(reduced.quarterTurns, 0);
  ASSERT_LE(reduced.quarterTurns, 3);
  const long double rest = restOf(angle, reduced.quarterTurns);
  const long double found = static_cast<long double>(reduced.remainder) + reduced.tail;
  EXPECT_LE(std::fabs(found - rest), std::ldexp(std::fabs(rest), -61)) << std::hexfloat << angle;
  EXPECT_LE(std::fabs(reduced.remainder), std::numbers::pi / 4 * (1 + 1e-15)) << std::hexfloat << angle;
  EXPECT_LE(std::fabs(reduced.tail), std::ldexp(std::fabs(reduced.remainder), -53)) << std::hexfloat << angle;
  // The cosine of the rest is positive: it is the angle's own, or that of a quarter turn less.
  const long double exact = angle;
  const long double cosines[] = {std::cos(exact), std::sin(exact), -std::cos(exact), -std::sin(exact)};
  EXPECT_GT(cosines[reduced.quarterTurns], 0.7L) << std::hexfloat << angle;
}

TEST(AngleReduction, LeavesTheRestOfAnglesOfAllSizes) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> mantissa(1, 2);
  for (int exponent = -3; exponent < 1024; ++exponent)
    for (int i = 0; i < 20; ++i) {
      const double angle = std::ldexp(mantissa(random), exponent);
      expectReduced(angle);
      expectReduced(-angle);
    }
}

// Below pi/4 nothing is taken out.
TEST(AngleReduction, KeepsSmallAngles) {
  for (const double angle : {0.0, 1e-300, -0.5, 0.785, -0.785}) {
    EXPECT_EQ(reduceAngle(angle).quarterTurns, 0);
    EXPECT_EQ(reduceAngle(angle).remainder, angle);
    EXPECT_EQ(reduceAngle(angle).tail, 0);
  }
  EXPECT_EQ(reduceAngle(0.786).quarterTurns, 1);
  EXPECT_EQ(reduceAngle(-0.786).quarterTurns, 3);
}

TEST(AngleReduction, IsExactNextToQuarterTurns) {
  for (int i = 1; i < 20000; ++i) {
    const double angle = static_cast<double>(i * (std::numbers::pi_v<long double> / 2));
    for (const double near : {angle, std::nextafter(angle, 0), -std::nextafter(angle, INFINITY)}) expectReduced(near);
    EXPECT_EQ(reduceAngle(angle).quarterTurns, i % 4);
    EXPECT_EQ(reduceAngle(-angle).quarterTurns, (4 - i % 4) % 4);
  }
}

// The double that comes closest to a multiple of pi/2, 2^-61 of a quarter turn (J.-M. Muller, "Elementary Functions",
// ch. 11). The rest is that by 400 digits of pi.
TEST(AngleReduction, IsExactForTheHardestAngle) {
  const double angle = 6381956970095103 * 0x1p797;
  EXPECT_EQ(reduceAngle(angle).quarterTurns, 1);
  EXPECT_NEAR(reduceAngle(angle).remainder, 4.687165924254627611e-19, 1e-34);  // half of its last place
  expectReduced(angle);
  expectReduced(-angle);
}

}  // namespace
}  // namespace cradle
