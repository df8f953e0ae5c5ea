// The format: numpy.lib.format. The header is a Python literal, with its keys in alphabetical order, as NumPy and
// `cradle render` write it.

#include "verify/npy_reader.h"

#include <fmt/format.h>

#include <cstring>
#include <string_view>

#include "core/error.h"
#include "core/read_file.h"

namespace cradle {
namespace {

constexpr std::string_view kMagic("\x93NUMPY\x01\x00", 8);
constexpr std::size_t kBeforeHeader = 10;      // bytes: magic, version, length of the header
constexpr std::size_t kLongestHeader = 65535;  // bytes, that two of them can tell

template <class Number>
constexpr const char* kTypeName = nullptr;
template <>
constexpr const char* kTypeName<float> = "<f4";
template <>
constexpr const char* kTypeName<std::uint16_t> = "<u2";
template <>
constexpr const char* kTypeName<std::uint8_t> = "|u1";

std::string withoutSpaces(std::string_view text) {
  std::string packed;
  for (const char c : text)
    if (c != ' ' && c != '\n') packed += c;
  return packed;
}

/// The header that a file must have, without spaces.
std::string headerOf(const char* type, const std::vector<std::size_t>& shape) {
  return fmt::format("{{'descr':'{}','fortran_order':False,'shape':({}),}}", type, fmt::join(shape, ","));
}

[[noreturn]] void refuseNpy(const std::string& path, const std::string& found) {
  throw Error(ErrorKind::usage, path, found + "; draw it again with `cradle render --overwrite`");
}

}  // namespace

template <class Number>
std::vector<Number> readNpy(const std::string& path, const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t size : shape) count *= size;
  const std::size_t whole = count * sizeof(Number);
  const std::string bytes = readFile(path, kBeforeHeader + kLongestHeader + whole, ErrorKind::usage);
  if (bytes.size() < kBeforeHeader || std::string_view(bytes).substr(0, kMagic.size()) != kMagic)
    refuseNpy(path, "is no NumPy file of version 1.0");
  const std::size_t headerSize = static_cast<std::size_t>(static_cast<unsigned char>(bytes[8])) +
                                 (static_cast<std::size_t>(static_cast<unsigned char>(bytes[9])) << 8);
  const std::string header = withoutSpaces(std::string_view(bytes).substr(kBeforeHeader, headerSize));
  const std::string expected = headerOf(kTypeName<Number>, shape);
  if (header != expected) refuseNpy(path, fmt::format("has the header {}; expected is {}", header, expected));
  const std::size_t begin = kBeforeHeader + headerSize;
  if (bytes.size() != begin + whole)
    refuseNpy(path, fmt::format("has {} bytes; its header promises {}", bytes.size(), begin + whole));
  std::vector<Number> numbers(count);
  std::memcpy(numbers.data(), bytes.data() + begin, whole);
  return numbers;
}

template std::vector<float> readNpy(const std::string& path, const std::vector<std::size_t>& shape);
template std::vector<std::uint16_t> readNpy(const std::string& path, const std::vector<std::size_t>& shape);
template std::vector<std::uint8_t> readNpy(const std::string& path, const std::vector<std::size_t>& shape);

}  // namespace cradle
