#include "commands/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "commands/drawing_memory.h"
#include "commands/film_drawer.h"
#include "commands/number_pair.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "image/png.h"
#include "image/video.h"
#include "scene/ranges.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr Range kFilmRates{1e-3, 1e5};  // 1/s

struct FrameRange {
  long first, end;  // half-open
};

/// FIRST:END, of which either may be left out, or one frame. Without END, to `count`.
std::optional<FrameRange> parseRange(const std::optional<std::string>& text, long count) {
  if (!text || text->empty() || *text == ":") return std::nullopt;
  std::string whole = *text;
  if (whole.starts_with(':')) whole = "0" + whole;
  if (whole.ends_with(':')) whole += std::to_string(count);
  if (const auto range = parsePair(whole, ':')) return FrameRange{range->first, range->second};
  const auto one = parsePair(whole + ":0", ':');
  if (!one || one->first == std::numeric_limits<long>::max()) return std::nullopt;
  return FrameRange{one->first, one->first + 1};
}

/// The frames to draw; the last frame of the trajectory may be named, though a film leaves it out.
FrameRange parseFrames(const std::optional<std::string>& text, const TrajectorySource& source) {
  if (!text) return {0, source.pictureCount()};
  const auto range = parseRange(text, source.pictureCount());
  const long count = source.frameCount();
  if (!range || range->first < 0 || range->end <= range->first || range->end > count)
    throw Error(ErrorKind::usage, "--frames",
                fmt::format("found \"{}\"; allowed is FIRST:END with 0 <= FIRST < END <= {}, FIRST:, :END or one frame",
                            *text, count));
  return *range;
}

constexpr long kMaxFrames = 1'000'000;  // that file names have digits for

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

/// Refuses a folder with frames that a run would replace without being told to. Without `range`, all frames are its
/// own.
void requireRoom(const std::string& folder, const std::optional<FrameRange>& range, const PictureOptions& options) {
  requireOwnFolder(folder, "frame", [](const std::string& name) { return frameNumber(name).has_value(); });
  const std::vector<long> there = framesIn(folder, range.value_or(FrameRange{0, kMaxFrames}));
  if (there.empty() || options.overwrite) return;
  throw Error(
      ErrorKind::output, folder,
      fmt::format("holds {} of the frames to be drawn, {} to {}; name a new or empty folder, or say --overwrite to "
                  "replace them",
                  there.size(), frameName(there.front()), frameName(there.back())));
}

/// Holds the folder, once it is there, and refuses it as requireRoom does: what another run has put there before that
/// is seen. Runs that draw parts of a film share it.
void takeFolder(const std::string& folder, const std::optional<FrameRange>& range, const PictureOptions& options,
                std::optional<FolderLock>& lock) {
  std::error_code missing;
  if (lock) return;
  if (fs::is_directory(folder, missing)) lock.emplace(folder, options.frames ? FolderUse::shared : FolderUse::alone);
  requireRoom(folder, range, options);
}

/// Frames that the film has not would get between its own when it is encoded.
void requireNoOthers(const std::string& folder, long frameCount) {
  const std::vector<long> others = framesIn(folder, {frameCount, kMaxFrames});
  if (others.empty()) return;
  throw Error(
      ErrorKind::output, folder,
      fmt::format("holds {} to {}, which are of another film, for this one has {} frames; remove them, or name a "
                  "new or empty folder",
                  frameName(others.front()), frameName(others.back()), frameCount));
}

}  // namespace

void renderFrames(const std::string& input, const std::string& folder, const PictureOptions& options, bool quiet) {
  std::optional<ResultFolder> made;  // outlives the lock
  std::optional<FolderLock> lock;
  takeFolder(folder, parseRange(options.frames, kMaxFrames), options, lock);
  if (options.overlay) parseOverlays(*options.overlay);
  TrajectorySource source(input, quiet, {.assetRoot = options.assetRoot});
  const PictureOrder order(options, source.scene());
  const FrameRange range = parseFrames(options.frames, source);
  requireNoOthers(folder, source.frameCount());
  source.simulate();
  requireDrawingMemory(order.size.width, order.size.height);  // of what is left
  FilmDrawer drawer(source, order);
  made.emplace(folder);
  takeFolder(folder, range, options, lock);
  Progress progress("Drawing", "pictures", range.end - range.first, quiet);
  drawFrames(
      range.first, range.end, progress, [&](long frame) { return drawer.draw(frame); },
      [&](long frame, const Image& picture) { writePng(picture, (fs::path(folder) / frameName(frame)).string()); });
}

void encodeFrames(const std::string& folder, const std::string& film, double framesPerSecond, bool quiet) {
  if (!kFilmRates.holds(framesPerSecond))
    throw Error(ErrorKind::usage, "--frames-per-second",
                fmt::format("found {}; allowed are numbers from {:g} to {:g}", framesPerSecond, kFilmRates.least,
                            kFilmRates.most));
  std::optional<Progress> progress;
  encodeFolder(folder, film, framesPerSecond, [&](long done, long total) {
    throwIfInterrupted();
    if (!progress) progress.emplace("Encoding", "pictures", total, quiet);
    progress->update(done);
  });
}

}  // namespace cradle
