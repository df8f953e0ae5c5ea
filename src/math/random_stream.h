#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace cradle {

/// Ten rounds of Philox 4x32 (J. Salmon, M. Moraes, R. Dror, D. Shaw, "Parallel random numbers: as easy as 1, 2, 3",
/// SC 2011): 128 random bits that are a function of a counter and a key.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

/// Random numbers that depend on nothing but a seed, the indices of their stream and how many were taken from it: the
/// same bits on every machine, in any order of streams.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : key_(seed) {}

  /// The stream with one more index, or name: independent of this one and of how far that is.
  RandomStream at(std::uint64_t index) const;
  RandomStream at(std::string_view name) const;

  std::uint64_t nextBits();
  /// Uniform over 2^52 numbers inside (0, 1), 0.5 their middle: neither 0 nor 1 is among them.
  double nextUniform();

 private:
  std::uint64_t key_;
  std::uint64_t taken_ = 0;
};

/// The number that a standard normal variable falls below with a probability in (0, 1): |error| < 1e-15 of it
/// (M. Wichura, "Algorithm AS 241: the percentage points of the normal distribution", Applied Statistics 37, 1988,
/// PPND16).
double normalQuantile(double probability);

}  // namespace cradle
