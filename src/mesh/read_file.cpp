#include "mesh/read_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/error.h"

namespace cradle {

std::string readFile(const std::string& path, std::uint64_t limit) {
  const auto fail = [&](const std::string& what) { throw Error(ErrorKind::mesh, path, what); };
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail("no such file; check the path");
  if (error) fail("cannot be read: " + error.message());
  if (std::filesystem::is_directory(status)) fail("is a directory, not a mesh file");
  if (!std::filesystem::is_regular_file(status)) fail("is not a regular file");

  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error) fail("cannot be read: " + error.message());
  if (size == 0) fail("is empty");
  if (size > limit)
    fail(fmt::format("has {} MB, more than the {} MB allowed; reduce the mesh", size >> 20, limit >> 20));

  std::ifstream stream(path, std::ios::binary);
  if (!stream) fail(std::string("cannot be opened: ") + std::strerror(errno));
  std::string bytes(size, '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) fail("cannot be read to its end");
  return bytes;
}

}  // namespace cradle
