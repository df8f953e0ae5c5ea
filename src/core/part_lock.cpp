// Locks are POSIX's: they end with their process, and tell which it is.

#include "core/part_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/error.h"
#include "core/output_path.h"

namespace cradle {
namespace {

constexpr const char* kAnother = "another process";

/// Of the whole file.
struct flock writeLock() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

/// Who is in the way of `lock`; nothing if nobody is.
std::optional<std::string> holderOf(int file, struct flock lock) {
  if (fcntl(file, F_GETLK, &lock) != 0 || lock.l_type == F_UNLCK) return std::nullopt;
  return lock.l_pid > 0 ? fmt::format("process {}", lock.l_pid) : kAnother;
}

std::string holderOf(int file) {
  return holderOf(file, writeLock()).value_or(kAnother);
}

bool isTheOneAt(const std::string& path, const struct stat& file) {
  struct stat there {};
  return lstat(path.c_str(), &there) == 0 && there.st_dev == file.st_dev && there.st_ino == file.st_ino;
}

/// Of a part that nobody else writes: as it is, or, if not `isKept`, a new file. (A program that a killed run has
/// started may still write into the old one.)
int openPart(const std::string& path, bool isKept) {
  const std::string part = partPath(path);
  requireWritableFile(path);
  requireWritablePlace(part);
  for (;;) {
    bool isNew = true;
    int file = open(part.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0 && errno == EEXIST) {
      isNew = false;
      file = open(part.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
      if (file < 0 && errno == ENOENT) continue;  // its writer has just given it its name, or removed it
    }
    const auto fail = [&](const std::string& what) {
      if (file >= 0) close(file);
      throw Error(ErrorKind::output, part, what);
    };
    if (file < 0 && errno == ELOOP) fail("is a link; it is not followed: remove it, or choose another name");
    if (file < 0) fail(fmt::format("cannot be written: {}", std::strerror(errno)));
    struct stat status {};
    if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) fail("is not a regular file and is not replaced");
    if (status.st_nlink > 1) fail("is a file with another name, too; remove it, or choose another name");
    struct flock lock = writeLock();
    const bool isTaken = fcntl(file, F_SETLK, &lock) != 0 && (errno == EACCES || errno == EAGAIN);
    if (isTaken) fail(fmt::format("is being written by {}; wait for its end or choose another name", holderOf(file)));
    const bool isThere = isTheOneAt(part, status);
    if (isThere && (isNew || isKept)) return file;
    if (isThere && unlink(part.c_str()) != 0) fail(fmt::format("cannot be removed: {}", std::strerror(errno)));
    close(file);
  }
}

}  // namespace

int openLockedPart(const std::string& path) {
  return openPart(path, true);
}

void flushToDisk(int file, const std::string& path) {
  // What is no disk has nothing to wait for.
  if (fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP) return;
  throw Error(ErrorKind::output, path, fmt::format("cannot be written: {}", std::strerror(errno)));
}

void flushFolderOf(const std::string& path) {
  const std::string folder = parentOf(path);
  if (access(folder.c_str(), R_OK) != 0) return;  // files can be made in it, but it cannot be opened
  const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool isFlushed = file >= 0 && (fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP);
  const int error = errno;
  if (file >= 0) close(file);
  if (isFlushed) return;
  throw Error(ErrorKind::output, path,
              fmt::format("is complete, but its folder cannot be written to the disk: {}", std::strerror(error)));
}

void requireNoWriter(const std::string& part) {
  const int file = open(part.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return;
  struct flock lock = writeLock();
  lock.l_type = F_RDLCK;  // other readers are not in its way
  const std::optional<std::string> writer = holderOf(file, lock);
  close(file);
  if (writer)
    throw Error(ErrorKind::output, part,
                fmt::format("is being written by {}; wait for its end or choose another name", *writer));
}

PartLock::PartLock(const std::string& path)
    : path_(path), part_(partPath(path)), file_(openPart(path, false)), remains_(std::in_place, part_.c_str()) {}

PartLock::~PartLock() {
  if (!isFinished_) unlink(part_.c_str());  // while it is locked: later it may be another run's
  close(file_);
}

void PartLock::finish() {
  flushToDisk(file_, path_);
  requireWritableFile(path_);  // what stands in the way may have changed; rename itself would replace a device
  if (std::rename(part_.c_str(), path_.c_str()) != 0)
    throw Error(ErrorKind::output, path_, fmt::format("cannot be put in place: {}", std::strerror(errno)));
  isFinished_ = true;
  remains_.reset();
  flushFolderOf(path_);
}

std::string lockHolderOf(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC);
  const std::string holder = holderOf(file);
  if (file >= 0) close(file);
  return holder;
}

}  // namespace cradle
