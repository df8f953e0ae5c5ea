#pragma once

#include <optional>
#include <string>

#include "core/crash.h"

namespace cradle {

/// The place of a file that is whole or not there: FILE.part, empty, open for writing and locked against other runs,
/// which becomes FILE when complete, and goes when not.
class PartLock {
 public:
  /// Throws Error(output) if `path` or its part is anything but a regular file of one name (what a link leads to is not
  /// overwritten), cannot be written, or is being written by another process, which is named. An earlier part is
  /// removed.
  explicit PartLock(const std::string& path);
  ~PartLock();
  PartLock(const PartLock&) = delete;
  PartLock& operator=(const PartLock&) = delete;

  int file() const { return file_; }  // descriptor

  /// Gives the part its name. Throws Error(output).
  void finish();

 private:
  std::string path_, part_;
  int file_ = -1;
  bool isFinished_ = false;
  std::optional<Remains> remains_;  // the part
};

/// The part of `path` as it is, or new and empty, open for reading and writing, and locked against other runs until it
/// is closed. Throws as PartLock does.
int openLockedPart(const std::string& path);

/// What is on the disk outlives a loss of power. Throws Error(output), naming `path`.
void flushToDisk(int file, const std::string& path);

/// The name of `path`, new or changed, outlives it, too, where folders can be flushed. Throws Error(output).
void flushFolderOf(const std::string& path);

/// Throws Error(output), naming the process, if another one writes the file `part`, by a lock of a PartLock or of
/// SQLite. This process has none on it, or loses it.
void requireNoWriter(const std::string& part);

/// "process 4711", that holds a lock on the file at `path`, or "another process".
std::string lockHolderOf(const std::string& path);

}  // namespace cradle
