#include "commands/frame_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/error.h"
#include "core/output_path.h"
#include "truth/passes.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

// Of a whole film. SQLite has a journal beside a trajectory that is being written.
constexpr std::array<const char*, 7> kFilmFiles = {
    kCameraFile, kEventsFile, kOriginFile, kKeptTrajectory, kSceneFile, kRecordFile, "trajectory.sqlite.part-journal"};

std::string endingOf(const std::string& kind) {
  if (kind == kPictureKind) return ".png";
  if (kind == kInstancesKind) return ".json";
  return kind == kPassesKind ? ".exr" : ".npy";
}

std::vector<std::string> allKinds() {
  std::vector<std::string> kinds = {kPictureKind, kHiddenKind, kInstancesKind, kPassesKind};
  for (const Pass pass : parsePasses("all")) kinds.emplace_back(nameOf(pass));
  return kinds;
}

/// A name without what marks an unfinished file.
std::string finishedName(const std::string& name) {
  return name.ends_with(".part") ? name.substr(0, name.size() - 5) : name;
}

bool isOurs(const std::string& name) {
  const std::string whole = finishedName(name);
  return std::find(kFilmFiles.begin(), kFilmFiles.end(), whole) != kFilmFiles.end() || parseFrameFile(name).has_value();
}

/// The files of frames in a folder that are in a range, and of some kinds, in the order of their frames.
std::vector<FrameFile> filesIn(const std::string& folder, const FrameRange& range,
                               const std::vector<std::string>& kinds) {
  std::vector<FrameFile> files;
  std::error_code missing;  // none in a folder that is still to be made
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, missing)) {
    const auto file = parseFrameFile(entry.path().filename().string());
    if (!file || file->frame < range.first || file->frame >= range.end) continue;
    if (std::find(kinds.begin(), kinds.end(), file->kind) != kinds.end()) files.push_back(*file);
  }
  std::sort(files.begin(), files.end(), [](const FrameFile& a, const FrameFile& b) {
    return std::pair(a.frame, a.kind) < std::pair(b.frame, b.kind);
  });
  return files;
}

}  // namespace

std::string frameFileName(const FrameFile& file) {
  return fmt::format("{}_{:06}{}", file.kind, file.frame, endingOf(file.kind));
}

std::optional<FrameFile> parseFrameFile(const std::string& name) {
  const std::string whole = finishedName(name);
  const std::size_t digits = whole.rfind('_') + 1;
  if (whole.find_first_not_of("0123456789", digits) != digits + 6 || digits == 0) return std::nullopt;
  const FrameFile file{whole.substr(0, digits - 1), std::stol(whole.substr(digits, 6))};
  const std::vector<std::string> kinds = allKinds();
  const bool isKnown = std::find(kinds.begin(), kinds.end(), file.kind) != kinds.end() && whole == frameFileName(file);
  return isKnown ? std::optional(file) : std::nullopt;
}

void requireFramesAlone(const std::string& folder) {
  requireOwnFolder(folder, "frame", isOurs);
}

std::vector<long> framesToDraw(const std::string& folder, const FrameRange& range,
                               const std::vector<std::string>& kinds) {
  std::vector<long> frames;
  const auto isThere = [&](const std::string& kind) {
    return fs::exists(fs::path(folder) / frameFileName({kind, frames.back()}));
  };
  for (long frame = range.first; frame < range.end; ++frame) {
    frames.push_back(frame);
    if (std::all_of(kinds.begin(), kinds.end(), isThere)) frames.pop_back();
  }
  return frames;
}

void requireRoom(const std::string& folder, const FrameRange& range, const std::vector<std::string>& kinds,
                 bool overwrites) {
  requireFramesAlone(folder);
  const std::vector<FrameFile> there = filesIn(folder, range, kinds);
  if (there.empty() || overwrites) return;
  throw Error(
      ErrorKind::output, folder,
      fmt::format("holds {} of the frames to be drawn, {} to {}; name a new or empty folder, or say --overwrite to "
                  "replace them",
                  there.size(), frameFileName(there.front()), frameFileName(there.back())));
}

void requireNoOthers(const std::string& folder, long frameCount) {
  const std::vector<FrameFile> others = filesIn(folder, {frameCount, kMaxFrames}, allKinds());
  if (others.empty()) return;
  throw Error(
      ErrorKind::output, folder,
      fmt::format("holds {} to {}, which are of another film, for this one has {} frames; remove them, or name a "
                  "new or empty folder",
                  frameFileName(others.front()), frameFileName(others.back()), frameCount));
}

}  // namespace cradle
