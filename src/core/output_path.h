#pragma once

#include <functional>
#include <string>

namespace cradle {

/// Throws Error(output) unless a file can be put at `path`: nothing or a regular file is there, in a folder that exists
/// and may be written to, and the name is none of an unfinished output. Devices and links are refused, so that they are
/// never replaced. Writes nothing.
void requireWritableFile(const std::string& path);

/// The same whatever the name.
void requireWritablePlace(const std::string& path);

/// Throws Error(output) if both are one file.
void requireOtherFile(const std::string& output, const std::string& input);

/// Throws Error(output) unless `folder` is there or can be made, may be written to, and holds nothing but files whose
/// names are ours; `kind` says in a word what those are ("frame"). Writes nothing.
void requireOwnFolder(const std::string& folder, const std::string& kind,
                      const std::function<bool(const std::string& name)>& isOurs);

/// Makes the folder if it is not there. Throws Error(output).
void makeFolder(const std::string& folder);

/// The folder that holds the file or folder `path`, "." for a bare name; nothing need be there.
std::string parentOf(const std::string& path);

/// Where the file that will be `path` is written until it is complete.
std::string partPath(const std::string& path);
bool isPartPath(const std::string& path);

}  // namespace cradle
