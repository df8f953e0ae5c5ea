#pragma once

#include <optional>
#include <string>
#include <vector>

#include "image/image.h"

namespace cradle {

/// Numbers of frames, half-open.
struct FrameRange {
  long first = 0, end = 0;
};

/// A folder of pictures frame_000000.png, ... that a run adds to. What it has written goes with the object, and the
/// folder if it was made for it, unless kept.
class FrameFolder {
 public:
  /// Throws Error(output) if the folder holds anything but frames, or frames of `range` (of any number, without one) and
  /// these are not to be replaced. Writes nothing.
  FrameFolder(std::string folder, const std::optional<FrameRange>& range, bool overwrite);
  ~FrameFolder();
  FrameFolder(const FrameFolder&) = delete;
  FrameFolder& operator=(const FrameFolder&) = delete;

  /// Throws Error(output) if there are frames beyond the end of a film of `frameCount`: they would get into it when it
  /// is encoded.
  void requireNoOthers(long frameCount) const;

  /// Makes the folder if it is not there. Throws Error(output).
  void make();

  void write(long number, const Image& picture);

  /// What was written so far stays.
  void keep() { isKept_ = true; }

 private:
  std::string folder_;
  bool isMade_ = false, isKept_ = false;
  std::vector<std::string> written_;  // paths
};

}  // namespace cradle
