#include "math/random_stream.h"

#include <cmath>

#include "math/elementary.h"

namespace cradle {
namespace {

// Of Philox 4x32, table 2 of the paper: two multipliers, and what the key grows by in a round (Weyl sequences of the
// golden ratio and of sqrt(3) - 1).
constexpr std::array<std::uint32_t, 2> kMultipliers = {0xD2511F53U, 0xCD9E8D57U};
constexpr std::array<std::uint32_t, 2> kKeySteps = {0x9E3779B9U, 0xBB67AE85U};
constexpr int kRounds = 10;

// Counters of what a key is asked for: the last word keeps numbers apart from keys of streams below it.
enum Purpose : std::uint32_t { kNumbers, kIndices, kNames, kEndOfName };

std::uint32_t lowWord(std::uint64_t bits) {
  return static_cast<std::uint32_t>(bits);
}

std::uint32_t highWord(std::uint64_t bits) {
  return static_cast<std::uint32_t>(bits >> 32U);
}

/// 64 bits that are a function of a key and 64 others.
std::uint64_t mixed(std::uint64_t key, std::uint64_t bits, Purpose purpose) {
  const auto block = philox({lowWord(bits), highWord(bits), 0, purpose}, {lowWord(key), highWord(key)});
  return std::uint64_t{block[1]} << 32U | block[0];
}

/// The quotient of two polynomials, given by their coefficients from the highest power on.
double quotient(const std::array<double, 8>& above, const std::array<double, 8>& below, double x) {
  double numerator = 0, denominator = 0;
  for (const double coefficient : above) numerator = numerator * x + coefficient;
  for (const double coefficient : below) denominator = denominator * x + coefficient;
  return numerator / denominator;
}

// Coefficients of AS 241, those of the highest power first: of the middle, and of two parts of the tail.
constexpr std::array kMiddleAbove = {2509.0809287301226727, 33430.575583588128105, 67265.770927008700853,
                                     45921.953931549871457, 13731.693765509461125, 1971.5909503065514427,
                                     133.14166789178437745, 3.387132872796366608};
constexpr std::array kMiddleBelow = {
    5226.495278852545925,  28729.085735721942674, 39307.89580009271061,  21213.794301586595867,
    5394.1960214247511077, 687.1870074920579083,  42.313330701600911252, 1.0};
constexpr std::array kTailAbove = {7.74545014278341407640e-4, 0.0227238449892691845833, 0.24178072517745061177,
                                   1.27045825245236838258,    3.64784832476320460504,   5.7694972214606914055,
                                   4.6303378461565452959,     1.42343711074968357734};
constexpr std::array kTailBelow = {
    1.05075007164441684324e-9, 5.475938084995344946e-4, 0.0151986665636164571966, 0.14810397642748007459,
    0.68976733498510000455,    1.6763848301838038494,   2.05319162663775882187,   1.0};
constexpr std::array kFarTailAbove = {2.01033439929228813265e-7, 2.71155556874348757815e-5, 0.0012426609473880784386,
                                      0.026532189526576123093,   0.29656057182850489123,    1.7848265399172913358,
                                      5.4637849111641143699,     6.6579046435011037772};
constexpr std::array kFarTailBelow = {
    2.04426310338993978564e-15, 1.4215117583164458887e-7, 1.8463183175100546818e-5, 7.868691311456132591e-4,
    0.0148753612908506148525,   0.13692988092273580531,   0.59983220655588793769,   1.0};
constexpr double kMiddle = 0.425;          // |p - 1/2| up to which the middle is taken
constexpr double kTailEnd = 5;             // sqrt(-log(tail)) up to which the first part of the tail is taken
constexpr double kMiddleShift = 0.180625;  // kMiddle squared
constexpr double kTailShift = 1.6;

}  // namespace

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < kRounds; ++round) {
    const std::uint64_t even = std::uint64_t{kMultipliers[0]} * counter[0];
    const std::uint64_t odd = std::uint64_t{kMultipliers[1]} * counter[2];
    counter = {highWord(odd) ^ counter[1] ^ key[0], lowWord(odd), highWord(even) ^ counter[3] ^ key[1], lowWord(even)};
    for (std::size_t i = 0; i < 2; ++i) key[i] += kKeySteps[i];
  }
  return counter;
}

RandomStream RandomStream::at(std::uint64_t index) const {
  return RandomStream(mixed(key_, index, kIndices));
}

RandomStream RandomStream::at(std::string_view name) const {
  constexpr std::size_t kBytes = 8;  // of a name, at a time
  std::uint64_t key = key_;
  for (std::size_t first = 0; first < name.size(); first += kBytes) {
    std::uint64_t bits = 0;
    for (const char byte : name.substr(first, kBytes)) bits = bits << 8U | static_cast<unsigned char>(byte);
    key = mixed(key, bits, kNames);
  }
  return RandomStream(mixed(key, name.size(), kEndOfName));
}

std::uint64_t RandomStream::nextBits() {
  return mixed(key_, taken_++, kNumbers);
}

double RandomStream::nextUniform() {
  constexpr double kStep = 0x1p-52;
  return (static_cast<double>(nextBits() >> 12U) + 0.5) * kStep;
}

double normalQuantile(double probability) {
  const double fromMiddle = probability - 0.5;
  if (std::abs(fromMiddle) <= kMiddle) {
    const double x = kMiddleShift - fromMiddle * fromMiddle;
    return fromMiddle * quotient(kMiddleAbove, kMiddleBelow, x);
  }
  const double tail = fromMiddle < 0 ? probability : 1 - probability;
  const double depth = std::sqrt(-log(tail));
  const double magnitude = depth <= kTailEnd ? quotient(kTailAbove, kTailBelow, depth - kTailShift)
                                             : quotient(kFarTailAbove, kFarTailBelow, depth - kTailEnd);
  return fromMiddle < 0 ? -magnitude : magnitude;
}

}  // namespace cradle
