#include "commands/picture_order.h"

#include <fmt/format.h>

#include "commands/number_pair.h"
#include "core/error.h"
#include "film/drawing_memory.h"
#include "overlay/caption_check.h"
#include "scene/ranges.h"

namespace cradle {
namespace {

PictureSize parseSize(const std::optional<std::string>& text, const Scene& scene) {
  if (!text) return {scene.output.width, scene.output.height};
  const auto size = parsePair(*text, 'x');
  if (!size)
    throw Error(ErrorKind::usage, "--size", fmt::format("found \"{}\"; allowed is WIDTHxHEIGHT, as 1280x720", *text));
  for (const long edge : {size->first, size->second})
    if (edge < 1 || edge > kLargestPicture)
      throw Error(ErrorKind::usage, "--size",
                  fmt::format("found {}; allowed are 1 to {} pixels", edge, kLargestPicture));
  return {static_cast<int>(size->first), static_cast<int>(size->second)};
}

}  // namespace

PictureOrder pictureOrderOf(const PictureOptions& options, const Scene& scene) {
  PictureOrder order{parseSize(options.size, scene), options.shaders.value_or("")};
  requireDrawingMemory(order.size.width, order.size.height);
  requireRoomForWords(scene, order.size.width, order.size.height);
  if (options.overlay) order.overlays = parseOverlays(*options.overlay);
  if (order.overlays && order.overlays->plot == PlotKind::height) plottedBody(*order.overlays, scene);
  return order;
}

}  // namespace cradle
