#pragma once

#include <string>
#include <string_view>

#include "core/part_lock.h"

namespace cradle {

/// A file that is whole or not there: it grows as FILE.part, which becomes FILE when complete, and goes when not.
class PartFile {
 public:
  /// Throws as PartLock does.
  explicit PartFile(const std::string& path) : path_(path), lock_(path) {}

  /// Throws Error(output), on a full disk at the latest in complete().
  void write(std::string_view bytes);
  void complete();

 private:
  void flush();
  void put(std::string_view bytes);

  std::string path_, waiting_;
  PartLock lock_;
};

/// Puts a whole file there, or none. Throws Error(output).
void writeWholeFile(const std::string& path, std::string_view bytes);

}  // namespace cradle
