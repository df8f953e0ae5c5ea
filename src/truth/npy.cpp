#include "truth/npy.h"

#include <fmt/format.h>

#include <bit>

#include "core/error.h"

namespace cradle {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kAlignment = 64;  // of the numbers, from the start of the file

/// `type` is NumPy's name of the numbers' type.
template <class Number>
std::string bytesOf(const std::vector<Number>& numbers, const std::vector<std::size_t>& shape, const char* type) {
  std::size_t count = 1;
  std::string sizes;
  for (const std::size_t size : shape) count *= size, sizes += (sizes.empty() ? "" : ", ") + std::to_string(size);
  CRADLE_CHECK(count == numbers.size());
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", type, sizes);
  const std::size_t before = 10;  // magic, version, length of the header
  header.append(kAlignment - 1 - (before + header.size()) % kAlignment, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  return bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
}

}  // namespace

std::string npyBytes(const std::vector<float>& numbers, const std::vector<std::size_t>& shape) {
  return bytesOf(numbers, shape, "<f4");
}

std::string npyBytes(const std::vector<std::uint16_t>& numbers, const std::vector<std::size_t>& shape) {
  return bytesOf(numbers, shape, "<u2");
}

std::string npyBytes(const std::vector<std::uint8_t>& numbers, const std::vector<std::size_t>& shape) {
  return bytesOf(numbers, shape, "|u1");
}

}  // namespace cradle
