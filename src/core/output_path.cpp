#include "core/output_path.h"

#include <fmt/format.h>
#include <unistd.h>

#include <climits>
#include <filesystem>
#include <string_view>

#include "core/error.h"

namespace cradle {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kPart = ".part";
// SQLite's journal of FILE.part has the longest name of those beside a file.
constexpr std::size_t kLongestName = NAME_MAX - std::string_view(".part-journal").size();  // bytes
constexpr std::size_t kLongestPath = PATH_MAX - 64;                                        // bytes

void requireUsableName(const std::string& path) {
  if (path.empty()) throw Error(ErrorKind::output, "the output", "has an empty name; give one");
  if (isPartPath(path))
    throw Error(ErrorKind::output, path, "ends in .part, as names of unfinished outputs do; give another name");
  const std::size_t length = fs::path(path).filename().string().size();
  if (length > kLongestName)
    throw Error(ErrorKind::output, path,
                fmt::format("has a name of {} bytes; at most {} are allowed", length, kLongestName));
  if (path.size() > kLongestPath)
    throw Error(ErrorKind::output, path,
                fmt::format("has a path of {} bytes; at most {} are allowed", path.size(), kLongestPath));
}

/// Whether files can be made in a folder.
bool mayBeWrittenTo(const fs::path& folder) {
  return access(folder.c_str(), W_OK | X_OK) == 0;
}

}  // namespace

void requireWritableFile(const std::string& path) {
  requireUsableName(path);
  requireWritablePlace(path);
}

void requireWritablePlace(const std::string& path) {
  std::error_code failed;
  const fs::file_status there = fs::status(path, failed);
  const bool isLink = fs::is_symlink(fs::symlink_status(path, failed));
  if (isLink && (fs::is_regular_file(there) || !fs::exists(there)))
    throw Error(
        ErrorKind::output, path,
        "is a link to " + fs::read_symlink(path, failed).string() + ", which is not replaced; name the file itself");
  if (fs::path(path).filename().empty() || fs::is_directory(there))
    throw Error(ErrorKind::output, path, "is a folder; give the name of a file");
  if (fs::exists(there) && !fs::is_regular_file(there))
    throw Error(ErrorKind::output, path, "is not a regular file and is not replaced; give another name");

  const std::string folder = parentOf(path);
  if (fs::exists(folder, failed) && !fs::is_directory(folder, failed))
    throw Error(ErrorKind::output, path, folder + " is no folder; name one");
  if (!fs::is_directory(folder, failed))
    throw Error(ErrorKind::output, path, "the folder " + folder + " does not exist; make it first");
  if (!mayBeWrittenTo(folder))
    throw Error(ErrorKind::output, path, "the folder " + folder + " may not be written to; choose another");
}

void requireOtherFile(const std::string& output, const std::string& input) {
  std::error_code failed;
  if (fs::equivalent(output, input, failed))
    throw Error(ErrorKind::output, output, "is the input, which is not replaced; give another name");
}

void requireOwnFolder(const std::string& folder, const std::string& kind,
                      const std::function<bool(const std::string& name)>& isOurs) {
  requireUsableName(folder);
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw Error(ErrorKind::output, folder, "is no folder; name a new or empty one");
  if (!fs::exists(folder, error)) {
    const fs::path parent = parentOf(folder);
    if (!fs::is_directory(parent, error))
      throw Error(ErrorKind::output, folder, "its parent folder does not exist; make it first");
    if (!mayBeWrittenTo(parent))
      throw Error(ErrorKind::output, folder, "its parent folder may not be written to; choose another");
    return;
  }
  if (!mayBeWrittenTo(folder)) throw Error(ErrorKind::output, folder, "may not be written to; choose another");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (isOurs(name)) continue;
    throw Error(ErrorKind::output, folder, "holds " + name + ", which is no " + kind + "; name a new or empty folder");
  }
  if (error) throw Error(ErrorKind::output, folder, "cannot be read: " + error.message());
}

void makeFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directory(folder, error);
  if (error) throw Error(ErrorKind::output, folder, "cannot be made: " + error.message());
}

std::string parentOf(const std::string& path) {
  const fs::path whole(path);
  const fs::path named = whole.has_filename() ? whole : whole.parent_path();  // without a slash at its end
  return named.has_parent_path() ? named.parent_path().string() : ".";
}

std::string partPath(const std::string& path) {
  return path + std::string(kPart);
}

bool isPartPath(const std::string& path) {
  return path.ends_with(kPart);
}

}  // namespace cradle
