#include "commands/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <future>

#include "commands/film_view.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "image/png.h"
#include "image/video.h"
#include "overlay/film_overlay.h"
#include "render/renderer.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

struct Size {
  int width, height;  // pixels
};
constexpr int kLargestSize = 16384;  // pixels; as in scene files

struct FrameRange {
  long first, end;  // half-open
};

/// Two whole numbers around a separator; nothing else.
std::optional<std::pair<long, long>> parsePair(const std::string& text, char separator) {
  std::pair<long, long> pair;
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, pair.first);
  if (first.ec != std::errc() || first.ptr == end || *first.ptr != separator) return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, pair.second);
  if (second.ec != std::errc() || second.ptr != end) return std::nullopt;
  return pair;
}

Size parseSize(const std::optional<std::string>& text, const Scene& scene) {
  if (!text) return {scene.output.width, scene.output.height};
  const auto size = parsePair(*text, 'x');
  if (!size)
    throw Error(ErrorKind::usage, "--size", fmt::format("found \"{}\"; allowed is WIDTHxHEIGHT, as 1280x720", *text));
  for (const long edge : {size->first, size->second})
    if (edge < 1 || edge > kLargestSize)
      throw Error(ErrorKind::scene, "--size", fmt::format("found {}; allowed are 1 to {} pixels", edge, kLargestSize));
  return {static_cast<int>(size->first), static_cast<int>(size->second)};
}

/// The frames to draw; the last frame of the trajectory may be named, though a film leaves it out.
FrameRange parseFrames(const std::optional<std::string>& text, const TrajectorySource& source) {
  if (!text) return {0, source.pictureCount()};
  const auto range = parsePair(*text, ':');
  const long count = source.reader().frameCount();
  if (!range || range->first < 0 || range->second <= range->first || range->second > count)
    throw Error(ErrorKind::usage, "--frames",
                fmt::format("found \"{}\"; allowed is FIRST:END with 0 <= FIRST < END <= {}", *text, count));
  return {range->first, range->second};
}

bool isFrameName(const std::string& name) {
  return name.size() == 16 && name.starts_with("frame_") && name.ends_with(".png") &&
         name.find_first_not_of("0123456789", 6) == 12;
}

std::string frameName(long frame) {
  return fmt::format("frame_{:06}.png", frame);
}

/// Nothing if no overlay is asked for.
std::optional<FilmOverlay> overlayOf(const TrajectorySource& source, const PictureOptions& options, const View& view) {
  if (!options.overlay) return std::nullopt;
  const TrajectoryReader& reader = source.reader();
  const FilmRecord film{source.scene(), view, [&reader](long number) { return reader.readFrame(number); },
                        reader.frameCount(), reader.events()};
  return std::optional<FilmOverlay>(std::in_place, film, parseOverlays(*options.overlay, source.scene()));
}

/// Draws frames in order and hands each picture on in a thread beside the drawing of the next one.
template <class Take>
void drawFrames(const TrajectorySource& source, const PictureOptions& options, const FrameRange& range, bool quiet,
                const Take& take) {
  const Size size = parseSize(options.size, source.scene());
  const View view = viewOf(source, size.width, size.height);
  std::optional<FilmOverlay> overlay = overlayOf(source, options, view);
  Renderer renderer(source.scene(), view, size.width, size.height, options.shaders.value_or(""));
  Progress progress("Drawing", "pictures", range.end - range.first, quiet);
  std::future<void> taken;
  for (long frame = range.first; frame < range.end; ++frame) {
    throwIfInterrupted();
    const Frame state = source.reader().readFrame(frame);
    Image image = renderer.render(state);
    if (overlay) overlay->draw(state, image);
    if (taken.valid()) taken.get();
    taken = std::async(std::launch::async, [&take, frame, picture = std::move(image)] { take(frame, picture); });
    progress.update(frame - range.first + 1);
  }
  taken.get();
}

}  // namespace

void renderFrames(const std::string& input, const std::string& folder, const PictureOptions& options, bool quiet) {
  requireOwnFolder(folder, "frame", isFrameName);
  const TrajectorySource source(input, quiet);
  const FrameRange range = parseFrames(options.frames, source);
  parseSize(options.size, source.scene());
  if (options.overlay) parseOverlays(*options.overlay, source.scene());
  makeFolder(folder);
  drawFrames(source, options, range, quiet, [&](long frame, const Image& picture) {
    writePng(picture, (fs::path(folder) / frameName(frame)).string());
  });
}

void encodeFrames(const std::string& folder, const std::string& film, double framesPerSecond, bool quiet) {
  std::optional<Progress> progress;
  encodeFolder(folder, film, framesPerSecond, [&](long done, long total) {
    throwIfInterrupted();
    if (!progress) progress.emplace("Encoding", "pictures", total, quiet);
    progress->update(done);
  });
}

void makeFilm(const std::string& input, const std::string& film, const PictureOptions& options, bool quiet) {
  requireWritableFile(film);
  const TrajectorySource source(input, quiet);
  const Size size = parseSize(options.size, source.scene());
  if (options.overlay) parseOverlays(*options.overlay, source.scene());
  VideoEncoder encoder(film, {size.width, size.height, source.scene().output.framesPerSecond});
  drawFrames(source, options, {0, source.pictureCount()}, quiet,
             [&](long, const Image& picture) { encoder.add(picture); });
  encoder.finish();
}

}  // namespace cradle
