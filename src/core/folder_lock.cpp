// A folder cannot be opened for writing, as POSIX's locks need: flock(2). Who holds such a lock is in proc(5),
// /proc/locks.

#include "core/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "core/output_path.h"

namespace cradle {
namespace {

/// By its number in the file system: the device's there is not always that of stat(2).
std::string holderOf(int folder) {
  struct stat status {};
  if (fstat(folder, &status) != 0) return "another process";
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::string number, kind, isAdvisory, access, place;
    long process = 0;
    std::istringstream(line) >> number >> kind >> isAdvisory >> access >> process >> place;
    const bool isOfFolder = place.ends_with(fmt::format(":{}", status.st_ino));
    if (kind == "FLOCK" && isOfFolder && process > 0) return fmt::format("process {}", process);
  }
  return "another process";
}

}  // namespace

FolderLock::FolderLock(const std::string& folder, FolderUse use)
    : file_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (file_ < 0) throw Error(ErrorKind::output, folder, fmt::format("cannot be read: {}", std::strerror(errno)));
  if (flock(file_, (use == FolderUse::alone ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  const std::string holder = holderOf(file_);
  close(file_);
  throw Error(ErrorKind::output, folder,
              fmt::format("is being written to by {}; wait for its end or choose another folder", holder));
}

FolderLock::~FolderLock() {
  close(file_);
}

ResultFolder::ResultFolder(const std::string& folder) : folder_(folder) {
  struct stat ignored {};
  isNew_ = stat(folder.c_str(), &ignored) != 0;
  makeFolder(folder);
}

ResultFolder::~ResultFolder() {
  if (!isNew_) return;
  const int file = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  if (flock(file, LOCK_EX | LOCK_NB) == 0) rmdir(folder_.c_str());  // fails if something is in it
  close(file);
}

}  // namespace cradle
