// Several runs can draw parts of a film into one folder.

#include "commands/frame_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/error.h"
#include "core/output_path.h"
#include "image/png.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr long kMostFrames = 1'000'000;  // that file names have digits for

/// The number of a frame's file, or of one that is being written; nothing for other names.
std::optional<long> frameNumber(const std::string& name) {
  const std::string whole = name.ends_with(".part") ? name.substr(0, name.size() - 5) : name;
  const bool isFrame = whole.size() == 16 && whole.starts_with("frame_") && whole.ends_with(".png") &&
                       whole.find_first_not_of("0123456789", 6) == 12;
  return isFrame ? std::optional(std::stol(whole.substr(6, 6))) : std::nullopt;
}

std::string frameName(long frame) {
  return fmt::format("frame_{:06}.png", frame);
}

/// Numbers of the frames in a folder that are in a range, ascending.
std::vector<long> framesIn(const std::string& folder, const FrameRange& range) {
  std::vector<long> numbers;
  std::error_code missing;  // none in a folder that is still to be made
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, missing)) {
    const auto number = frameNumber(entry.path().filename().string());
    if (number && *number >= range.first && *number < range.end) numbers.push_back(*number);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

}  // namespace

FrameFolder::FrameFolder(std::string folder, const std::optional<FrameRange>& range, bool overwrite)
    : folder_(std::move(folder)) {
  requireOwnFolder(folder_, "frame", [](const std::string& name) { return frameNumber(name).has_value(); });
  const std::vector<long> there = framesIn(folder_, range.value_or(FrameRange{0, kMostFrames}));
  if (there.empty() || overwrite) return;
  throw Error(
      ErrorKind::output, folder_,
      fmt::format("holds {} of the frames to be drawn, {} to {}; name a new or empty folder, or say --overwrite to "
                  "replace them",
                  there.size(), frameName(there.front()), frameName(there.back())));
}

FrameFolder::~FrameFolder() {
  if (isKept_) return;
  std::error_code ignored;  // there is an error under way that says more
  for (const std::string& path : written_) fs::remove(path, ignored);
  if (isMade_) fs::remove(folder_, ignored);
}

void FrameFolder::requireNoOthers(long frameCount) const {
  const std::vector<long> others = framesIn(folder_, {frameCount, kMostFrames});
  if (others.empty()) return;
  throw Error(
      ErrorKind::output, folder_,
      fmt::format("holds {} to {}, which are of another film, for this one has {} frames; remove them, or name a "
                  "new or empty folder",
                  frameName(others.front()), frameName(others.back()), frameCount));
}

void FrameFolder::make() {
  isMade_ = !fs::exists(folder_);
  makeFolder(folder_);
}

void FrameFolder::write(long number, const Image& picture) {
  written_.push_back((fs::path(folder_) / frameName(number)).string());
  writePng(picture, written_.back());
}

}  // namespace cradle
