#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cradle {

/// Bytes as text that browsers unpack: gzip, then base64.
std::string packed(std::span<const std::uint8_t> bytes);

/// Numbers in the order of this machine, which is that of browsers.
template <class Number>
std::string packed(const std::vector<Number>& numbers) {
  return packed({reinterpret_cast<const std::uint8_t*>(numbers.data()), numbers.size() * sizeof(Number)});
}

}  // namespace cradle
