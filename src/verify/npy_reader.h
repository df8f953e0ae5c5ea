#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cradle {

/// The numbers of a NumPy file of format version 1.0 in C order, which must have this shape and, by the type of Number,
/// be little-endian float32, uint16 or uint8. Throws Error(usage) if the file is missing, or anything else, as one that
/// was cut off or has more behind its numbers.
template <class Number>
std::vector<Number> readNpy(const std::string& path, const std::vector<std::size_t>& shape);

extern template std::vector<float> readNpy(const std::string& path, const std::vector<std::size_t>& shape);
extern template std::vector<std::uint16_t> readNpy(const std::string& path, const std::vector<std::size_t>& shape);
extern template std::vector<std::uint8_t> readNpy(const std::string& path, const std::vector<std::size_t>& shape);

}  // namespace cradle
