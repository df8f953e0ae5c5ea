#include "film/film_drawer.h"

#include <vector>

#include "overlay/captions.h"

namespace cradle {

FilmDrawer::FilmDrawer(FilmSource& motion, const PictureOrder& order, const std::optional<View>& view)
    : motion_(motion),
      view_(view ? *view : viewOf(motion_, order.size.width, order.size.height)),
      camera_(cameraOf(motion_, view_)),
      renderer_(motion_.drawnScene(), view_, order.size.width, order.size.height, order.shaders) {
  if (motion_.isWhole() && motion_.drawnScene().camera) camera_.at(motion_.drawnFrameAt(motion_.frameCount() - 1));
  if (!order.overlays) return;
  const FilmRecord film{motion_.drawnScene(),
                        view_,
                        order.size.width,
                        order.size.height,
                        [this](long number) { return motion_.drawnFrameAt(number); },
                        motion_.frameCount(),
                        motion_.isWhole() ? motion_.drawnEvents() : std::vector<Event>(),
                        [this](long number) { return motion_.drawnContactsAt(number); },
                        motion_.isWhole() ? motion_.reader().horizon() : std::nullopt};
  overlay_.emplace(film, *order.overlays);
}

Image FilmDrawer::draw(long number) {
  const Frame frame = motion_.drawnFrameAt(number);
  motion_.forgetBefore(number);
  const Camera camera = camera_.at(frame);
  Image image = renderer_.render(frame, camera);
  if (overlay_) overlay_->draw(frame, image);
  if (!motion_.drawnScene().captions.empty())
    drawCaptions(motion_.drawnScene(), frame, {camera, image.width, image.height},
                 overlay_ ? overlay_->upperPanels(image.width, image.height) : std::vector<PicturePart>(), image);
  return image;
}

}  // namespace cradle
