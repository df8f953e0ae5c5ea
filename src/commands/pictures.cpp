#include "commands/pictures.h"

#include <fmt/format.h>

#include <charconv>
#include <future>

#include "commands/film_view.h"
#include "commands/frame_folder.h"
#include "commands/simulate_scene.h"
#include "core/error.h"
#include "core/interruption.h"
#include "core/output_path.h"
#include "core/progress.h"
#include "image/video.h"
#include "overlay/film_overlay.h"
#include "render/renderer.h"

namespace cradle {
namespace {

struct Size {
  int width, height;  // pixels
};
constexpr int kLargestSize = 16384;  // pixels; as in scene files

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

std::optional<FrameRange> parseRange(const std::optional<std::string>& text) {
  const auto range = text ? parsePair(*text, ':') : std::nullopt;
  return range ? std::optional(FrameRange{range->first, range->second}) : std::nullopt;
}

/// The frames to draw; the last frame of the trajectory may be named, though a film leaves it out.
FrameRange parseFrames(const std::optional<std::string>& text, const TrajectorySource& source) {
  if (!text) return {0, source.pictureCount()};
  const auto range = parseRange(text);
  const long count = source.frameCount();
  if (!range || range->first < 0 || range->end <= range->first || range->end > count)
    throw Error(ErrorKind::usage, "--frames",
                fmt::format("found \"{}\"; allowed is FIRST:END with 0 <= FIRST < END <= {}", *text, count));
  return *range;
}

/// What the command line says of pictures. Whatever is wrong with it shows before anything moves.
struct PictureOrder {
  PictureOrder(const PictureOptions& options, const Scene& scene)
      : size(parseSize(options.size, scene)), shaders(options.shaders.value_or("")) {
    if (options.overlay) overlays = parseOverlays(*options.overlay);
    if (overlays && overlays->plot == PlotKind::height) plottedBody(*overlays, scene);
  }

  Size size;
  std::string shaders;
  std::optional<OverlayChoice> overlays;
};

/// What draws the frames of a film, beside the simulation if neither its view nor its overlays wait for the end.
struct FilmDrawer {
  FilmDrawer(const TrajectorySource& trajectory, const PictureOrder& order)
      : source(trajectory),
        view(viewOf(source, order.size.width, order.size.height)),
        renderer(source.scene(), view, order.size.width, order.size.height, order.shaders) {
    if (!order.overlays) return;
    if (needsWholeFilm(*order.overlays)) source.waitForEnd();
    const FilmRecord film{source.scene(),
                          view,
                          order.size.width,
                          order.size.height,
                          [this](long number) { return source.frame(number); },
                          source.frameCount(),
                          source.reader().events()};
    overlay.emplace(film, *order.overlays);
  }

  Image draw(long number) {
    const Frame frame = source.frame(number);
    Image image = renderer.render(frame);
    if (overlay) overlay->draw(frame, image);
    return image;
  }

  const TrajectorySource& source;
  View view;
  Renderer renderer;
  std::optional<FilmOverlay> overlay;
};

/// Draws frames in order and hands each picture on in a thread beside the drawing of the next one; what is left of the
/// simulation then goes on to its end.
template <class Take>
void drawFrames(FilmDrawer& drawer, const FrameRange& range, bool quiet, const Take& take) {
  {
    Progress progress("Drawing", "pictures", range.end - range.first, quiet);
    std::future<void> taken;
    for (long frame = range.first; frame < range.end; ++frame) {
      throwIfInterrupted();
      Image image = drawer.draw(frame);
      printWarnings(drawer.source.takeWarnings(), progress);
      if (taken.valid()) taken.get();
      taken = std::async(std::launch::async, [&take, frame, picture = std::move(image)] { take(frame, picture); });
      progress.update(frame - range.first + 1);
    }
    taken.get();
  }
  drawer.source.waitForEnd();
}

/// Whether the pictures drawn before an error are worth keeping: others could be drawn beside them.
bool leavesGoodPictures(const Error& error, const TrajectorySource& source) {
  return source.isComplete() && (error.kind() == ErrorKind::interrupted || error.kind() == ErrorKind::output);
}

}  // namespace

void renderFrames(const std::string& input, const std::string& folder, const PictureOptions& options, bool quiet) {
  FrameFolder frames(folder, parseRange(options.frames), options.overwrite);
  if (options.overlay) parseOverlays(*options.overlay);
  TrajectorySource source(input, quiet);
  const PictureOrder order(options, source.scene());
  const FrameRange range = parseFrames(options.frames, source);
  frames.requireNoOthers(source.frameCount());

  source.start();
  if (options.overwrite) source.waitForEnd();  // a simulation that fails has replaced nothing
  FilmDrawer drawer(source, order);
  frames.make();
  try {
    drawFrames(drawer, range, quiet, [&](long frame, const Image& picture) { frames.write(frame, picture); });
    frames.keep();
  } catch (const Error& error) {
    if (leavesGoodPictures(error, source)) frames.keep();
    throw;
  }
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
  if (options.overlay) parseOverlays(*options.overlay);
  TrajectorySource source(input, quiet);
  const PictureOrder order(options, source.scene());
  VideoEncoder encoder(film, {order.size.width, order.size.height, source.scene().output.framesPerSecond});

  source.start();
  FilmDrawer drawer(source, order);
  drawFrames(drawer, {0, source.pictureCount()}, quiet, [&](long, const Image& picture) { encoder.add(picture); });
  encoder.finish();
}

}  // namespace cradle
