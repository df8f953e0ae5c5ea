#include "math/angle_reduction.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

// M. Payne, R. Hanek, "Radian reduction for trigonometric functions", ACM SIGNUM Newsletter 18(1), 1983: of the product
// of an angle m 2^e, m an integer, with 2/pi, those bits of 2/pi that give multiples of 4 quarter turns are left out
// before multiplying, and the rest is done in integers. No double comes closer than 2^-61 quarter turns to a multiple
// (J.-M. Muller, "Elementary Functions", ch. 11), so 126 bits of the fraction leave 65 of the remainder.

namespace cradle {
namespace {

__extension__ using Wide = unsigned __int128;

// 64 zeros, then the first 1216 binary digits of 2/pi.
constexpr std::array<std::uint64_t, 20> kTwoOverPi = {
    0,
    0xa2f9836e4e441529,
    0xfc2757d1f534ddc0,
    0xdb6295993c439041,
    0xfe5163abdebbc561,
    0xb7246e3a424dd2e0,
    0x06492eea09d1921c,
    0xfe1deb1cb129a73e,
    0xe88235f52ebb4484,
    0xe99c7026b45f7e41,
    0x3991d639835339f4,
    0x9c845f8bbdf9283b,
    0x1ff897ffde05980f,
    0xef2f118b5a0a6d1f,
    0x6d367ecf27cb09b7,
    0x4f463f669e5fea2d,
    0x7527bac7ebe5f17b,
    0x3d0739f78a5292ea,
    0x6bfb5fb11f8d5d08,
    0x56033046fc7b6bab,
};
constexpr double kHalfPiHigh = 0x1.921fb54442d18p+0, kHalfPiLow = 0x1.1a62633145c07p-54;  // pi/2 to 106 bits

/// angle * 2/pi modulo 4, in units of 2^-126, rounded down; angle = mantissa 2^exponent.
Wide quarterTurnsOf(std::uint64_t mantissa, int exponent) {
  // The digit worth 2 quarter turns, counted from the start of the table.
  const auto first = static_cast<unsigned>(exponent - 1 + 63);
  const unsigned word = first / 64, shift = first % 64;
  const auto digits = [&](unsigned i) {
    const std::uint64_t next = shift == 0 ? 0 : kTwoOverPi[word + i + 1] >> (64 - shift);
    return (kTwoOverPi[word + i] << shift) | next;
  };
  const Wide low = Wide{mantissa} * digits(2) >> 64;
  return (Wide{mantissa * digits(0)} << 64) + Wide{mantissa} * digits(1) + low;
}

/// a b with its rounding error (T. Dekker, "A floating-point technique for extending the available precision", Numer.
/// Math. 18, 1971), for a and b that do not overflow when multiplied by 2^27.
struct ExactProduct {
  double value, error;
};
ExactProduct multiplyExactly(double a, double b) {
  constexpr double kSplitter = 0x1p27 + 1;
  const double aHigh = kSplitter * a - (kSplitter * a - a), aLow = a - aHigh;
  const double bHigh = kSplitter * b - (kSplitter * b - b), bLow = b - bHigh;
  const double product = a * b;
  return {product, ((aHigh * bHigh - product) + aHigh * bLow + aLow * bHigh) + aLow * bLow};
}

/// fraction 2^-128 quarter turns, in rad; fraction > 0.
ReducedAngle radians(Wide fraction, double sign) {
  const auto topWord = static_cast<std::uint64_t>(fraction >> 64);
  const int zeros =
      topWord != 0 ? std::countl_zero(topWord) : 64 + std::countl_zero(static_cast<std::uint64_t>(fraction));
  const Wide bits = fraction << zeros;
  constexpr std::uint64_t kMantissaMask = (std::uint64_t{1} << 53) - 1;
  const double scale = sign * std::bit_cast<double>(static_cast<std::uint64_t>(1023 - zeros) << 52);
  const double high = scale * 0x1p-53 * static_cast<double>(static_cast<std::uint64_t>(bits >> 75));
  const double low = scale * 0x1p-106 * static_cast<double>(static_cast<std::uint64_t>(bits >> 22) & kMantissaMask);
  const ExactProduct product = multiplyExactly(high, kHalfPiHigh);
  const double rest = product.error + (high * kHalfPiLow + low * kHalfPiHigh);
  const double remainder = product.value + rest;
  return {0, remainder, rest - (remainder - product.value)};
}

}  // namespace

ReducedAngle reduceAngle(double angle) {
  constexpr double kQuarterPi = kHalfPiHigh / 2;
  if (std::fabs(angle) <= kQuarterPi) return {0, angle, 0};
  const auto bits = std::bit_cast<std::uint64_t>(std::fabs(angle));
  const auto mantissa = (bits & ((std::uint64_t{1} << 52) - 1)) | (std::uint64_t{1} << 52);
  const Wide turns = quarterTurnsOf(mantissa, static_cast<int>(bits >> 52) - 1075);
  const auto nearest = static_cast<unsigned>((turns + (Wide{1} << 125)) >> 126) % 4;  // the sum may wrap to 0
  const Wide fraction = turns << 2;  // the rest, of 2^128, in two's complement
  const bool isBelow = fraction >> 127 != 0;
  ReducedAngle reduced = radians(isBelow ? -fraction : fraction, isBelow == (angle < 0) ? 1 : -1);
  reduced.quarterTurns = static_cast<int>(angle < 0 ? (4 - nearest) % 4 : nearest);
  return reduced;
}

}  // namespace cradle
