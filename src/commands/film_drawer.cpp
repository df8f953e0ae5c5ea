#include "commands/film_drawer.h"

#include <fmt/format.h>

#include <numeric>

#include "commands/drawing_memory.h"
#include "commands/number_pair.h"
#include "core/error.h"
#include "overlay/caption_check.h"
#include "overlay/captions.h"

namespace cradle {
namespace {

constexpr int kLargestSize = 16384;  // pixels; as in scene files

PictureSize parseSize(const std::optional<std::string>& text, const Scene& scene) {
  if (!text) return {scene.output.width, scene.output.height};
  const auto size = parsePair(*text, 'x');
  if (!size)
    throw Error(ErrorKind::usage, "--size", fmt::format("found \"{}\"; allowed is WIDTHxHEIGHT, as 1280x720", *text));
  for (const long edge : {size->first, size->second})
    if (edge < 1 || edge > kLargestSize)
      throw Error(ErrorKind::usage, "--size", fmt::format("found {}; allowed are 1 to {} pixels", edge, kLargestSize));
  return {static_cast<int>(size->first), static_cast<int>(size->second)};
}

}  // namespace

PictureOrder::PictureOrder(const PictureOptions& options, const Scene& scene)
    : size(parseSize(options.size, scene)), shaders(options.shaders.value_or("")) {
  requireDrawingMemory(size.width, size.height);
  requireRoomForWords(scene, size.width, size.height);
  if (options.overlay) overlays = parseOverlays(*options.overlay);
  if (overlays && overlays->plot == PlotKind::height) plottedBody(*overlays, scene);
}

FilmDrawer::FilmDrawer(TrajectorySource& trajectory, const PictureOrder& order, const std::optional<View>& view)
    : source_(trajectory),
      view_(view ? *view : viewOf(source_, order.size.width, order.size.height)),
      camera_(cameraOf(source_, view_)),
      renderer_(source_.drawnScene(), view_, order.size.width, order.size.height, order.shaders) {
  if (source_.isWhole() && source_.drawnScene().camera) camera_.at(source_.drawnFrameAt(source_.frameCount() - 1));
  if (!order.overlays) return;
  const FilmRecord film{source_.drawnScene(),
                        view_,
                        order.size.width,
                        order.size.height,
                        [this](long number) { return source_.drawnFrameAt(number); },
                        source_.frameCount(),
                        source_.isWhole() ? source_.drawnEvents() : std::vector<Event>(),
                        [this](long number) { return source_.drawnContactsAt(number); },
                        source_.isWhole() ? source_.reader().horizon() : std::nullopt};
  overlay_.emplace(film, *order.overlays);
}

Image FilmDrawer::draw(long number) {
  const Frame frame = source_.drawnFrameAt(number);
  source_.forgetBefore(number);
  const Camera camera = camera_.at(frame);
  Image image = renderer_.render(frame, camera);
  if (overlay_) overlay_->draw(frame, image);
  if (!source_.drawnScene().captions.empty())
    drawCaptions(source_.drawnScene(), frame, {camera, image.width, image.height},
                 overlay_ ? overlay_->upperPanels(image.width, image.height) : std::vector<PicturePart>(), image);
  return image;
}

std::vector<long> framesIn(const FrameRange& range) {
  std::vector<long> frames(static_cast<std::size_t>(range.end - range.first));
  std::iota(frames.begin(), frames.end(), range.first);
  return frames;
}

}  // namespace cradle
