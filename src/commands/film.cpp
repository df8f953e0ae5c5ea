#include "commands/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>

#include "commands/draw_frames.h"
#include "commands/picture_order.h"
#include "commands/trajectory_source.h"
#include "commands/warnings.h"
#include "core/error.h"
#include "core/output_path.h"
#include "core/printable.h"
#include "film/drawing_memory.h"
#include "image/video.h"
#include "overlay/captions.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxBeside = 4;
constexpr double kHeadingHeight = 0.1;  // of a picture's

void addTitleCard(const Scene& scene, int width, int height, VideoEncoder& encoder) {
  if (!scene.titleCard) return;
  const Image card = drawTitleCard(*scene.titleCard, width, height);
  const long count = std::lround(scene.titleCard->seconds * scene.output.framesPerSecond);
  for (long i = 0; i < count; ++i) encoder.add(card);
}

/// One of the films that are shown beside each other.
class Part {
 public:
  Part(const std::string& input, const PictureOptions& options, bool quiet)
      : source(input, quiet, {.assetRoot = options.assetRoot}), order(pictureOrderOf(options, source.scene())) {}

  /// After source.simulateUntilItFails().
  void prepare(const std::optional<View>& view) {
    drawer_.emplace(source, order, view);
    const TrajectoryReader& reader = source.reader();
    const std::string& method = reader.header().method;
    heading_ = printableLine(method.substr(0, method.find('\n')));
    if (reader.hasFailed()) ending_ = fmt::format(": unstable after {:.3g} s", reader.frameTimes().back());
  }

  /// With its heading above it.
  const Image& draw(long frame) {
    const long last = lastPicture();
    const bool isOver = frame > last && !ending_.empty();
    if (frame <= last) picture_ = drawer_->draw(frame);
    if (frame <= last || isOver) image_ = withHeading(heading_ + (frame >= last ? ending_ : ""));
    return image_;
  }

  /// The last state is the end of a run that failed, and no picture of others.
  long lastPicture() const { return source.reader().hasFailed() ? source.frameCount() - 1 : source.pictureCount() - 1; }

  TrajectorySource source;
  PictureOrder order;

 private:
  Image withHeading(const std::string& heading) const {
    const int strip = static_cast<int>(std::ceil(kHeadingHeight * picture_.height));
    Image image = drawHeading(heading, picture_.width, strip);
    image.height += picture_.height;
    image.pixels.insert(image.pixels.end(), picture_.pixels.begin(), picture_.pixels.end());
    return image;
  }

  std::optional<FilmDrawer> drawer_;
  std::string heading_, ending_;
  Image picture_, image_;
};

void requireSameFrames(std::deque<Part>& parts, const std::vector<std::string>& inputs) {
  const Output& first = parts[0].source.scene().output;
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const Output& other = parts[i].source.scene().output;
    if (other.framesPerSecond != first.framesPerSecond || other.playbackSpeed != first.playbackSpeed)
      throw Error(ErrorKind::usage, inputs[i],
                  fmt::format("has {} frames a second at a playback speed of {}, {} has {} at {}; films side by side "
                              "need the same",
                              other.framesPerSecond, other.playbackSpeed, printableLine(inputs[0]),
                              first.framesPerSecond, first.playbackSpeed));
    if (parts[i].order.size != parts[0].order.size)
      throw Error(ErrorKind::usage, inputs[i], "has pictures of another size; give all one by --size");
  }
}

bool haveSameBodies(std::deque<Part>& parts) {
  const std::vector<Body>& first = parts[0].source.scene().bodies;
  return std::all_of(parts.begin(), parts.end(), [&](Part& part) {
    const std::vector<Body>& other = part.source.scene().bodies;
    return std::equal(first.begin(), first.end(), other.begin(), other.end(),
                      [](const Body& a, const Body& b) { return a.name == b.name; });
  });
}

/// Of the same bodies: that of the run that stays the smallest among those that last the longest.
std::optional<View> commonView(std::deque<Part>& parts) {
  const auto namesCamera = [](Part& part) { return part.source.scene().camera.has_value(); };
  if (!haveSameBodies(parts) || std::any_of(parts.begin(), parts.end(), namesCamera)) return std::nullopt;
  long longest = 0;
  for (Part& part : parts) longest = std::max(longest, part.source.pictureCount());
  std::optional<View> smallest;
  for (Part& part : parts) {
    if (part.source.pictureCount() < longest) continue;
    const View view = viewOf(part.source, part.order.size.width, part.order.size.height);
    if (!smallest || view.size() < smallest->size()) smallest = view;
  }
  return smallest;
}

Image besideEachOther(std::deque<Part>& parts, long frame) {
  std::vector<const Image*> images;
  for (Part& part : parts) images.push_back(&part.draw(frame));
  const auto count = static_cast<int>(images.size());
  Image joined(images[0]->width * count, images[0]->height);
  for (int i = 0; i < count; ++i) {
    const Image& image = *images[static_cast<std::size_t>(i)];
    for (int y = 0; y < image.height; ++y)
      std::memcpy(joined.at(i * image.width, y), image.at(0, y), static_cast<std::size_t>(image.width) * 3);
  }
  return joined;
}

void drawFilm(TrajectorySource& source, const PictureOrder& order, const std::string& film, bool quiet) {
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
  addTitleCard(source.scene(), order.size.width, order.size.height, encoder);
  drawFrames(
      framesIn({0, source.pictureCount()}), progress, [&](long frame) { return drawer.draw(frame); },
      [&](long, const Image& picture) { encoder.add(picture); });
  source.finish();
  encoder.finish();
}

}  // namespace

void makeFilm(const std::string& input, const std::string& film, const PictureOptions& options, bool quiet) {
  requireWritableFile(film);
  requireOtherFile(film, input);
  if (options.overlay) parseOverlays(*options.overlay);
  TrajectorySource source(input, quiet, {.assetRoot = options.assetRoot});
  const PictureOrder order = pictureOrderOf(options, source.scene());
  source.keepAt(film + ".sqlite");
  drawFilm(source, order, film, quiet);
}

void makeSideBySideFilm(const std::vector<std::string>& inputs, const std::string& film, const PictureOptions& options,
                        bool quiet) {
  if (inputs.size() < 2 || inputs.size() > kMaxBeside)
    throw Error(ErrorKind::usage, "--side-by-side",
                fmt::format("found {} scenes or trajectories; allowed are 2 to {}", inputs.size(), kMaxBeside));
  requireWritableFile(film);
  requireFilmName(film);
  for (const std::string& input : inputs) requireOtherFile(film, input);
  std::deque<Part> parts;
  for (const std::string& input : inputs) parts.emplace_back(input, options, quiet);
  requireSameFrames(parts, inputs);
  long count = 0;
  for (Part& part : parts) {
    part.source.simulateUntilItFails();
    count = std::max(count, part.lastPicture() + 1);
  }
  const std::optional<View> view = commonView(parts);
  for (Part& part : parts) part.prepare(view);
  Image picture = besideEachOther(parts, 0);
  const Scene& scene = parts[0].source.scene();
  VideoEncoder encoder(film, {picture.width, picture.height, scene.output.framesPerSecond});
  addTitleCard(scene, picture.width, picture.height, encoder);
  Progress progress("Drawing", "pictures", count, quiet);
  drawFrames(
      framesIn({0, count}), progress, [&](long frame) { return besideEachOther(parts, frame); },
      [&](long, const Image& drawn) { encoder.add(drawn); });
  encoder.finish();
}

}  // namespace cradle
