#pragma once

#include <cstdint>
#include <string>

namespace cradle {

/// All bytes of a regular file. Throws Error(mesh) that says what to do if it is missing, a directory, a device,
/// unreadable, empty, or larger than `limit` bytes.
std::string readFile(const std::string& path, std::uint64_t limit);

}  // namespace cradle
