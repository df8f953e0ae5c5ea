#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cradle {

/// Bytes as text that browsers unpack: gzip, then base64.
std::string packed(std::span<const std::uint8_t> bytes);

/// Numbers, little-endian as typed arrays of browsers are.
template <class Number>
std::string packed(const std::vector<Number>& numbers) {
  static_assert(std::endian::native == std::endian::little);
  return packed({reinterpret_cast<const std::uint8_t*>(numbers.data()), numbers.size() * sizeof(Number)});
}

}  // namespace cradle
