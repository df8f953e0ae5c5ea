#include "commands/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <limits>
#include <thread>

#include "commands/draw_frames.h"
#include "commands/frame_folder.h"
#include "commands/number_pair.h"
#include "commands/picture_order.h"
#include "commands/shard.h"
#include "commands/trajectory_source.h"
#include "commands/truth_film.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/part_file.h"
#include "core/progress.h"
#include "core/read_file.h"
#include "film/drawing_memory.h"
#include "image/png.h"
#include "image/video.h"
#include "scene/ranges.h"
#include "trajectory/copy_trajectory.h"
#include "trajectory/trajectory_file.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

constexpr Range kFilmRates{1e-3, 1e5};  // 1/s

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

/// Holds the folder, once it is there, and refuses it as requireRoom does: what another run has put there before that
/// is seen. Runs that draw parts of a film share it.
void takeFolder(const std::string& folder, const std::optional<FrameRange>& range, const PictureOptions& options,
                const std::vector<std::string>& kinds, std::optional<FolderLock>& lock) {
  std::error_code missing;
  if (lock) return;
  const FolderUse use = options.frames || options.shard ? FolderUse::shared : FolderUse::alone;
  if (fs::is_directory(folder, missing)) lock.emplace(folder, use);
  if (options.skipExisting || (options.shard && !range))  // frames of a part are known with the film
    requireFramesAlone(folder);
  else
    requireRoom(folder, range.value_or(FrameRange{0, kMaxFrames}), kinds, options.overwrite);
}

/// The frames of one of several parts that are as long as each other, but for one frame.
FrameRange shardOf(const FrameRange& range, const std::optional<std::string>& text) {
  if (!text) return range;
  const Shard shard = parseShard(*text);
  const long count = range.end - range.first;
  return {range.first + shard.begin(count), range.first + shard.end(count)};
}

/// Writes a file that runs beside this one may be writing with the same bytes: it waits for them.
void writeShared(const fs::path& path, const std::string& bytes) {
  constexpr int kAttempts = 100;
  constexpr std::chrono::milliseconds kPause(20);
  for (int attempt = 1;; ++attempt) {
    std::error_code missing;
    if (fs::file_size(path, missing) == bytes.size() &&
        readFile(path.string(), bytes.size(), ErrorKind::output) == bytes)
      return;
    try {
      return writeWholeFile(path.string(), bytes);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::output || attempt == kAttempts) throw;
    }
    std::this_thread::sleep_for(kPause);
  }
}

/// Whether another run is writing the file that will be `path`.
bool isBeingFilled(const std::string& path) {
  try {
    requireNoWriter(partPath(path));
  } catch (const Error&) {
    return true;
  }
  return false;
}

/// Keeps a simulated trajectory in the folder, once: a run beside this one may be writing it, and then it is waited
/// for.
void keepTrajectory(const TrajectoryReader& trajectory, const std::string& path) {
  constexpr std::chrono::milliseconds kPause(20);
  const auto isThere = [&] { return stateHashOf(path) == trajectory.stateHash(); };
  while (!isThere()) {
    throwIfInterrupted();
    try {
      return copyTrajectory(trajectory, path);
    } catch (const Error& error) {
      if (isThere()) return;
      if (error.kind() != ErrorKind::output || !isBeingFilled(path)) throw;
    }
    std::this_thread::sleep_for(kPause);
  }
}

/// Says in the folder what it is drawn from: a trajectory's file by its path, or the trajectory itself of a scene.
void writeOrigin(const TrajectorySource& source, const std::string& input, const fs::path& folder) {
  const TrajectoryReader& trajectory = source.reader();
  const bool isFile = isDatabaseFile(input);
  const bool isInside =
      isFile && fs::weakly_canonical(folder) == fs::weakly_canonical(fs::absolute(input)).parent_path();
  if (!isFile) keepTrajectory(trajectory, (folder / kKeptTrajectory).string());
  const std::string name = isInside ? fs::path(input).filename().string()
                           : isFile ? fs::absolute(input).lexically_normal().string()
                                    : kKeptTrajectory;
  writeShared(folder / kOriginFile,
              originJson(name, trajectory.isFinished() ? trajectory.stateHash() : trajectory.hashOfFrames()));
}

/// The kinds of files that a run writes for each frame.
std::vector<std::string> kindsOf(const std::vector<Pass>& passes, PassFormat format) {
  std::vector<std::string> kinds;
  if (std::find(passes.begin(), passes.end(), Pass::rgb) != passes.end()) kinds.push_back(kPictureKind);
  if (passes == std::vector{Pass::rgb}) return kinds;
  kinds.push_back(kInstancesKind);
  if (format == PassFormat::exr) {
    kinds.push_back(kPassesKind);
    return kinds;
  }
  for (const Pass pass : passes) {
    if (pass != Pass::rgb) kinds.emplace_back(nameOf(pass));
    if (pass == Pass::flow) kinds.push_back(kHiddenKind);
  }
  return kinds;
}

PassFormat parseFormat(const std::string& text) {
  if (text == "npy") return PassFormat::npy;
  if (text == "exr") return PassFormat::exr;
  throw Error(ErrorKind::usage, "--pass-format", fmt::format("found \"{}\"; allowed are npy and exr", text));
}

/// All that is known of a frame, as it goes into files.
struct FrameResult {
  std::optional<Image> picture;
  std::vector<FileBytes> truth;
};

}  // namespace

void renderFrames(const std::string& input, const std::string& folder, const PictureOptions& options, bool quiet) {
  const std::vector<Pass> passes = options.passes ? parsePasses(*options.passes) : std::vector{Pass::rgb};
  const PassFormat format = parseFormat(options.passFormat);
  const std::vector<std::string> kinds = kindsOf(passes, format);
  std::optional<ResultFolder> made;  // outlives the lock
  std::optional<FolderLock> lock;
  shardOf({0, 1}, options.shard);
  if (options.skipExisting && options.overwrite)
    throw Error(ErrorKind::usage, "--skip-existing", "goes without --overwrite: frames are kept or replaced");
  takeFolder(folder, options.shard ? std::nullopt : parseRange(options.frames, kMaxFrames), options, kinds, lock);
  if (options.overlay) parseOverlays(*options.overlay);
  TrajectorySource source(input, quiet, {.assetRoot = options.assetRoot});
  const PictureOrder order = pictureOrderOf(options, source.scene());
  const FrameRange range = shardOf(parseFrames(options.frames, source), options.shard);
  if (options.shard && !options.skipExisting) requireRoom(folder, range, kinds, options.overwrite);
  requireNoOthers(folder, source.frameCount());
  source.simulate();
  requireDrawingMemory(order.size.width, order.size.height);  // of what is left
  const View view = viewOf(source, order.size.width, order.size.height);
  std::optional<FilmDrawer> drawer;
  if (std::find(passes.begin(), passes.end(), Pass::rgb) != passes.end()) drawer.emplace(source, order, view);
  std::optional<TruthFilm> truth;
  if (passes != std::vector{Pass::rgb})
    truth.emplace(source, view, order.size.width, order.size.height, passes, format);
  made.emplace(folder);
  takeFolder(folder, range, options, kinds, lock);
  if (truth) {
    for (const FileBytes& file : truth->filesOfFilm()) writeShared(fs::path(folder) / file.name, file.bytes);
    writeOrigin(source, input, folder);
  }
  const std::vector<long> frames = options.skipExisting ? framesToDraw(folder, range, kinds) : framesIn(range);
  Progress progress("Drawing", "pictures", std::ssize(frames), quiet);
  drawFrames(
      frames, progress,
      [&](long frame) {
        FrameResult result;
        if (drawer) result.picture = drawer->draw(frame);
        if (truth) result.truth = truth->filesOf(frame);
        return result;
      },
      [&](long frame, const FrameResult& result) {
        const std::string picture = frameFileName({kPictureKind, frame});
        if (result.picture) writePng(*result.picture, (fs::path(folder) / picture).string());
        for (const FileBytes& file : result.truth) writeWholeFile((fs::path(folder) / file.name).string(), file.bytes);
      });
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
