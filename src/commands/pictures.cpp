#include "commands/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <future>
#include <limits>

#include "commands/drawing_memory.h"
#include "commands/film_view.h"
#include "commands/simulate_scene.h"
#include "core/error.h"
#include "core/folder_lock.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "image/png.h"
#include "image/video.h"
#include "overlay/film_overlay.h"
#include "render/renderer.h"
#include "scene/ranges.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

struct Size {
  int width, height;  // pixels
};
constexpr Range kFilmRates{1e-3, 1e5};  // 1/s
constexpr int kLargestSize = 16384;     // pixels; as in scene files

struct FrameRange {
  long first, end;  // half-open
};

/// Two whole numbers around a separator; nothing else. One too large for its type is the largest that is not.
std::optional<std::pair<long, long>> parsePair(const std::string& text, char separator) {
  std::pair<long, long> pair{std::numeric_limits<long>::max(), std::numeric_limits<long>::max()};
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, pair.first);
  if (first.ec == std::errc::invalid_argument || first.ptr == end || *first.ptr != separator) return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, pair.second);
  if (second.ec == std::errc::invalid_argument || second.ptr != end) return std::nullopt;
  return pair;
}

Size parseSize(const std::optional<std::string>& text, const Scene& scene) {
  if (!text) return {scene.output.width, scene.output.height};
  const auto size = parsePair(*text, 'x');
  if (!size)
    throw Error(ErrorKind::usage, "--size", fmt::format("found \"{}\"; allowed is WIDTHxHEIGHT, as 1280x720", *text));
  for (const long edge : {size->first, size->second})
    if (edge < 1 || edge > kLargestSize)
      throw Error(ErrorKind::usage, "--size", fmt::format("found {}; allowed are 1 to {} pixels", edge, kLargestSize));
  return {static_cast<int>(size->first), static_cast<int>(size->second)};
}

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

/// What the command line says of pictures. Whatever is wrong with it shows before anything is simulated.
struct PictureOrder {
  PictureOrder(const PictureOptions& options, const Scene& scene)
      : size(parseSize(options.size, scene)), shaders(options.shaders.value_or("")) {
    requireDrawingMemory(size.width, size.height);
    if (options.overlay) overlays = parseOverlays(*options.overlay);
    if (overlays && overlays->plot == PlotKind::height) plottedBody(*overlays, scene);
  }

  Size size;
  std::string shaders;
  std::optional<OverlayChoice> overlays;
};

/// What draws the frames of a film: whatever is wrong with its shaders, and with its camera as far as its way is known,
/// shows before a picture is made.
struct FilmDrawer {
  FilmDrawer(TrajectorySource& trajectory, const PictureOrder& order)
      : source(trajectory),
        view(viewOf(source, order.size.width, order.size.height)),
        camera(cameraOf(source, view)),
        renderer(source.scene(), view, order.size.width, order.size.height, order.shaders) {
    if (source.isWhole() && source.scene().camera) camera.at(source.frameAt(source.frameCount() - 1));
    if (!order.overlays) return;
    const FilmRecord film{source.scene(),
                          view,
                          order.size.width,
                          order.size.height,
                          [this](long number) { return source.frameAt(number); },
                          source.frameCount(),
                          source.isWhole() ? source.reader().events() : std::vector<Event>()};
    overlay.emplace(film, *order.overlays);
  }

  Image draw(long number) {
    const Frame frame = source.frameAt(number);
    source.forgetBefore(number);
    Image image = renderer.render(frame, camera.at(frame));
    if (overlay) overlay->draw(frame, image);
    return image;
  }

  TrajectorySource& source;
  View view;
  FilmCamera camera;
  Renderer renderer;
  std::optional<FilmOverlay> overlay;
};

/// Draws frames in order and hands each picture on in a thread beside the drawing of the next one.
template <class Take>
void drawFrames(FilmDrawer& drawer, const FrameRange& range, Progress& progress, const Take& take) {
  std::future<void> taken;
  for (long frame = range.first; frame < range.end; ++frame) {
    throwIfInterrupted();
    Image image = drawer.draw(frame);
    if (taken.valid()) taken.get();
    taken = std::async(std::launch::async, [&take, frame, picture = std::move(image)] { take(frame, picture); });
    progress.update(frame - range.first + 1);
  }
  taken.get();
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
  drawFrames(drawer, range, progress, [&](long frame, const Image& picture) {
    writePng(picture, (fs::path(folder) / frameName(frame)).string());
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

void makeFilm(const std::string& input, const std::string& film, const PictureOptions& options, bool quiet) {
  requireWritableFile(film);
  requireOtherFile(film, input);
  if (options.overlay) parseOverlays(*options.overlay);
  TrajectorySource source(input, quiet, {.assetRoot = options.assetRoot});
  const PictureOrder order(options, source.scene());
  VideoEncoder encoder(film, {order.size.width, order.size.height, source.scene().output.framesPerSecond});
  const bool drawsBeside = isSeenFromTheStart(source.scene()) && !(order.overlays && order.overlays->needsWholeFilm());
  if (!drawsBeside) source.simulate();
  Progress progress("Drawing", "pictures", source.pictureCount(), quiet);
  if (drawsBeside)
    source.simulateBeside(
        [&progress](const std::string& warning) {
          progress.endLine();
          warn(warning);
        },
        [&progress](double time) { progress.showTime(time); });
  requireDrawingMemory(order.size.width, order.size.height);  // of what is left
  FilmDrawer drawer(source, order);
  drawFrames(drawer, {0, source.pictureCount()}, progress, [&](long, const Image& picture) { encoder.add(picture); });
  source.finish();
  encoder.finish();
}

}  // namespace cradle
