#include "core/output_path.h"

#include <unistd.h>

#include <filesystem>

#include "core/error.h"

namespace cradle {

namespace fs = std::filesystem;

void requireWritableFile(const std::string& path) {
  std::error_code failed;
  const fs::file_status there = fs::status(path, failed);
  if (path.empty() || fs::path(path).filename().empty() || fs::is_directory(there))
    throw Error(ErrorKind::output, path, "is a folder; give the name of a file");
  if (fs::exists(there) && !fs::is_regular_file(there))
    throw Error(ErrorKind::output, path, "is not a regular file and is not replaced; give another name");

  const fs::path parent = fs::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  if (!fs::is_directory(folder, failed))
    throw Error(ErrorKind::output, path, "the folder " + folder + " does not exist; make it first");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw Error(ErrorKind::output, path, "the folder " + folder + " may not be written to; choose another");
}

std::string partPath(const std::string& path) {
  return path + ".part";
}

}  // namespace cradle
