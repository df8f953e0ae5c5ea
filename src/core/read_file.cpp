#include "core/read_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace cradle {

void requireFileOrFolder(const std::string& path, ErrorKind kind) {
  const auto fail = [&](const std::string& what) { throw Error(kind, path.empty() ? "\"\"" : path, what); };
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail("no such file; check the path");
  if (error) fail("cannot be read: " + error.message());
  if (!std::filesystem::is_directory(status) && !std::filesystem::is_regular_file(status))
    fail("is not a regular file; write its content into one");
}

void requireRegularFile(const std::string& path, ErrorKind kind) {
  requireFileOrFolder(path, kind);
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw Error(kind, path, "is a directory; name a file in it");
}

std::string readFile(const std::string& path, std::uint64_t limit, ErrorKind kind) {
  const auto fail = [&](const std::string& what) { throw Error(kind, path, what); };
  constexpr double kMegabyte = 1e6;
  std::error_code error;
  requireRegularFile(path, kind);

  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error) fail("cannot be read: " + error.message());
  if (size == 0) fail("is empty");
  if (size > limit)
    fail(fmt::format("has {:.1f} MB, more than the {:.4g} MB allowed",
                     std::ceil(10 * static_cast<double>(size) / kMegabyte) / 10,
                     static_cast<double>(limit) / kMegabyte));

  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(std::string("cannot be opened: ") + std::strerror(errno));
  std::string bytes(size, '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) fail("cannot be read to its end");
  return bytes;
}

bool holdsText(const std::string& path, const std::string& text) {
  std::error_code missing;
  return std::filesystem::file_size(path, missing) == text.size() && !missing &&
         readFile(path, text.size(), ErrorKind::output) == text;
}

bool isBelow(const std::string& path, const std::filesystem::path& folder) {
  std::error_code failed;
  const std::filesystem::path whole = std::filesystem::weakly_canonical(path, failed);
  if (failed) return false;
  return std::mismatch(folder.begin(), folder.end(), whole.begin(), whole.end()).first == folder.end();
}

}  // namespace cradle
