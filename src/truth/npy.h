#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cradle {

/// The bytes of a NumPy file of format version 1.0 (numpy.lib.format), in C order: float32, uint16 or uint8,
/// little-endian. `shape` has as many elements as there are numbers.
std::string npyBytes(const std::vector<float>& numbers, const std::vector<std::size_t>& shape);
std::string npyBytes(const std::vector<std::uint16_t>& numbers, const std::vector<std::size_t>& shape);
std::string npyBytes(const std::vector<std::uint8_t>& numbers, const std::vector<std::size_t>& shape);

}  // namespace cradle
