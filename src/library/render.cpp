#include <cradle/render.h>
#include <fmt/format.h>

#include <optional>
#include <utility>

#include "film/drawing_memory.h"
#include "film/film_drawer.h"
#include "library/drawing_thread.h"
#include "library/trajectory_content.h"
#include "library/translated.h"
#include "overlay/caption_check.h"
#include "overlay/overlay_choice.h"
#include "player/player_page.h"
#include "scene/ranges.h"

namespace cradle::v1 {
namespace {

PictureOrder orderOf(const PictureOptions& options, const cradle::Scene& scene) {
  PictureOrder order{{options.width != 0 ? options.width : scene.output.width,
                      options.height != 0 ? options.height : scene.output.height}};
  for (const int length : {order.size.width, order.size.height})
    if (length < 1 || length > kLargestPicture)
      throw cradle::Error(cradle::ErrorKind::usage, "size",
                          fmt::format("found {}; allowed are 1 to {} pixels", length, kLargestPicture));
  requireDrawingMemory(order.size.width, order.size.height);
  requireRoomForWords(scene, order.size.width, order.size.height);
  if (options.overlay.empty()) return order;
  order.overlays = parseOverlays(options.overlay);
  if (order.overlays->plot == PlotKind::height) plottedBody(*order.overlays, scene);
  return order;
}

}  // namespace

struct Film::Content {
  explicit Content(const Trajectory& trajectory) : motion(trajectory.content()->reader) {}

  FilmSource motion;
  std::optional<FilmDrawer> drawer;
};

Film::Film(const Trajectory& trajectory, const PictureOptions& options)
    : content_(translated([&] {
        auto content = std::make_unique<Content>(trajectory);
        const PictureOrder order = orderOf(options, content->motion.scene());
        DrawingThread::ofProcess().run([&] { content->drawer.emplace(content->motion, order); });
        return content;
      })) {}

Film::~Film() {
  if (DrawingThread::isLost())
    static_cast<void>(content_.release());  // the parent's
  else if (content_)
    DrawingThread::ofProcess().run([this] { content_.reset(); });
}

Film::Film(Film&&) noexcept = default;

Film& Film::operator=(Film&& other) noexcept {
  std::swap(content_, other.content_);
  return *this;
}

Picture Film::draw(long number) {
  if (!content_) throw Error(ErrorKind::usage, "a film that was moved from draws no picture");
  requireFrame(content_->motion.reader(), number);
  return translated([&] {
    Image image = DrawingThread::ofProcess().run([&] { return content_->drawer->draw(number); });
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
