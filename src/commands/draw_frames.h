#pragma once

#include <future>
#include <numeric>
#include <utility>
#include <vector>

#include "commands/frame_folder.h"
#include "core/interruption.h"
#include "core/progress.h"

namespace cradle {

/// All frames of a range.
inline std::vector<long> framesIn(const FrameRange& range) {
  std::vector<long> frames(static_cast<std::size_t>(range.end - range.first));
  std::iota(frames.begin(), frames.end(), range.first);
  return frames;
}

/// Draws frames in ascending order, and hands on what draw(frame) gives, to take(frame, drawn), in a thread beside the
/// drawing of the next one.
template <class Draw, class Take>
void drawFrames(const std::vector<long>& frames, Progress& progress, const Draw& draw, const Take& take) {
  std::future<void> taken;
  long done = 0;
  for (const long frame : frames) {
    throwIfInterrupted();
    auto drawn = draw(frame);
    if (taken.valid()) taken.get();
    taken = std::async(std::launch::async, [&take, frame, drawn = std::move(drawn)] { take(frame, drawn); });
    progress.update(++done);
  }
  if (taken.valid()) taken.get();
}

}  // namespace cradle
