#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/error.h"

namespace cradle {

/// Throws an Error of `kind` that says what to do if the file is missing, a folder, or a pipe or device (which may
/// never end).
void requireRegularFile(const std::string& path, ErrorKind kind);

/// The same where a folder will do, too.
void requireFileOrFolder(const std::string& path, ErrorKind kind);

/// All bytes of a regular file. Throws as requireRegularFile does, and if it is unreadable, empty, or larger than
/// `limit` bytes; then nothing of it is read.
std::string readFile(const std::string& path, std::uint64_t limit, ErrorKind kind);

/// Whether a regular file is there that holds this text, which is not empty, and nothing else.
bool holdsText(const std::string& path, const std::string& text);

/// Whether what `path` leads to, through all links, is below `folder`, which has none; nothing need be there.
bool isBelow(const std::string& path, const std::filesystem::path& folder);

}  // namespace cradle
