#pragma once

#include <string>

namespace cradle {

/// Whether a run fills a folder alone, or a part of it beside others that fill the rest.
enum class FolderUse { alone, shared };

/// While it lives, no other run of the program writes into a folder, but those that share it. Nothing of it is in the
/// folder, and it ends with its process.
class FolderLock {
 public:
  /// The folder is there. Throws Error(output), naming the process, if another one holds it. Where folders cannot be
  /// locked (on some network file systems) nothing is held.
  FolderLock(const std::string& folder, FolderUse use);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_ = -1;
};

/// A folder for results, made if it is not there. One that was made for a run which put nothing into it is gone with
/// the object, unless another run holds it by then.
class ResultFolder {
 public:
  /// Throws Error(output).
  explicit ResultFolder(const std::string& folder);
  ~ResultFolder();
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

 private:
  std::string folder_;
  bool isNew_ = false;
};

}  // namespace cradle
