#include <cradle/render.h>

#include <utility>

#include "film/drawing_memory.h"
#include "film/film_drawer.h"
#include "library/drawing_thread.h"
#include "library/trajectory_content.h"
#include "library/translated.h"
#include "overlay/caption_check.h"
#include "overlay/overlay_choice.h"
#include "player/player_page.h"

namespace cradle::v1 {
namespace {

PictureOrder orderOf(const PictureOptions& options, const cradle::Scene& scene) {
  PictureOrder order{{options.width > 0 ? options.width : scene.output.width,
                      options.height > 0 ? options.height : scene.output.height}};
  requireDrawingMemory(order.size.width, order.size.height);
  requireRoomForWords(scene, order.size.width, order.size.height);
  if (options.overlay.empty()) return order;
  order.overlays = parseOverlays(options.overlay);
  if (order.overlays->plot == PlotKind::height) plottedBody(*order.overlays, scene);
  return order;
}

}  // namespace

struct Film::Content {
  explicit Content(const Trajectory& trajectory, const PictureOptions& options)
      : motion(trajectory.content()->reader), drawer(motion, orderOf(options, motion.scene())) {}

  FilmSource motion;
  FilmDrawer drawer;
};

Film::Film(const Trajectory& trajectory, const PictureOptions& options)
    : content_(translated([&] {
        return DrawingThread::ofProcess().run([&] { return std::make_unique<Content>(trajectory, options); });
      })) {}

Film::~Film() {
  if (DrawingThread::isLost())
    static_cast<void>(content_.release());  // the parent's
  else if (content_)
    DrawingThread::ofProcess().run([this] { content_.reset(); });
}

Film::Film(Film&&) noexcept = default;

Picture Film::draw(long number) {
  requireFrame(content_->motion.reader(), number);
  return translated([&] {
    Image image = DrawingThread::ofProcess().run([&] { return content_->drawer.draw(number); });
    return Picture{image.width, image.height, std::move(image.pixels)};
  });
}

std::string playerPage(const Trajectory& trajectory) {
  return translated([&] {
    FilmSource motion(trajectory.content()->reader);
    std::string page;
    writePlayerPage(
        motion, nullptr, [](long) {}, [&page](std::string_view text) { page += text; });
    return page;
  });
}

}  // namespace cradle::v1
