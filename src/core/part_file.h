#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace cradle {

/// A file that is whole or not there: it grows as FILE.part, which becomes FILE when complete, and goes when not.
class PartFile {
 public:
  /// Throws Error(output) if anything but a regular file is at `path`, or it cannot be written; an earlier FILE.part is
  /// replaced.
  explicit PartFile(const std::string& path);
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// Throws Error(output), on a full disk at the latest in complete().
  void write(std::string_view bytes);
  void complete();

 private:
  [[noreturn]] void fail() const;

  std::string path_, part_;
  std::FILE* file_ = nullptr;
  bool isComplete_ = false;
};

}  // namespace cradle
