#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "math/types.h"

namespace cradle {

/// Equal keys share a number; numbers count up in order of first appearance.
struct Numbering {
  std::vector<std::uint32_t> numberOf;  // one a key
  std::vector<std::uint32_t> firstKey;  // of each number
};

/// The bits of `value`; those of -0 are those of 0.
inline std::uint64_t keyBits(double value) {
  return std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value);
}

/// Of this run: who writes a file cannot choose keys that all come to one place of a table. Numbers do not depend on
/// it.
inline std::uint64_t hashSeed() {
  static const std::uint64_t seed = std::uint64_t{std::random_device()()} << 32 | std::random_device()();
  return seed;
}

/// Numbers the keys keyOf(0) .. keyOf(count - 1), arrays of words; count < 2^31. O(n): a hash table with linear
/// probing.
template <typename KeyOf>
Numbering numberDistinct(std::size_t count, const KeyOf& keyOf) {
  constexpr std::uint32_t kEmpty = ~0U;
  const std::size_t mask = std::bit_ceil(count + count / 3 + 1) - 1;  // at most 3/4 full
  std::vector<std::uint32_t> table(mask + 1, kEmpty);
  const std::uint64_t seed = hashSeed();
  Numbering numbering;
  numbering.numberOf.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    const auto key = keyOf(k);
    std::uint64_t hash = seed;
    for (const std::uint64_t word : key) {
      hash = (hash ^ word) * 0x9E3779B97F4A7C15;  // 2^64 / golden ratio: Knuth's multiplicative hash
      hash ^= hash >> 32;
    }
    std::size_t slot = hash & mask;
    while (table[slot] != kEmpty && keyOf(numbering.firstKey[table[slot]]) != key) slot = (slot + 1) & mask;
    if (table[slot] == kEmpty) {
      table[slot] = static_cast<std::uint32_t>(numbering.firstKey.size());
      numbering.firstKey.push_back(static_cast<std::uint32_t>(k));
    }
    numbering.numberOf.push_back(table[slot]);
  }
  return numbering;
}

/// Numbers positions; bit-equal ones (-0 counts as 0) share a number.
inline Numbering numberPositions(const std::vector<Vec3>& positions) {
  return numberDistinct(positions.size(), [&](std::size_t i) {
    const Vec3& p = positions[i];
    return std::array{keyBits(p.x()), keyBits(p.y()), keyBits(p.z())};
  });
}

}  // namespace cradle
