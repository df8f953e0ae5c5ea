#pragma once

#include <string>

namespace cradle {

/// Throws Error(output) unless a file can be put at `path`: nothing or a regular file is there, in a folder that exists
/// and may be written to. Devices are refused, so that they are never replaced. Writes nothing.
void requireWritableFile(const std::string& path);

/// Where the file that will be `path` is written until it is complete.
std::string partPath(const std::string& path);

}  // namespace cradle
