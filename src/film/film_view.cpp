#include "film/film_view.h"

#include <algorithm>

namespace cradle {
namespace {

constexpr double kMaxWaiting = 1e6;  // states of bodies, 0.1 GB: of the frames until the last push

}  // namespace

View viewOf(FilmSource& source, int width, int height) {
  std::vector<ShownPush> pushes = findShownPushes(source.drawnScene(), source.drawnPushEvents(), [&source](long frame) {
    return source.drawnFrameAt(std::min(frame, source.frameCount() - 1));
  });
  Framing framing(source.drawnScene(), width, height, std::move(pushes));
  const long frames = source.scene().camera ? 1 : source.frameCount();
  for (long number = 0; number < frames; ++number) framing.add(source.drawnFrameAt(number));
  return framing.view();
}

bool isSeenFromTheStart(const Scene& scene) {
  double lastStart = 0;  // s
  for (const Push& push : scene.pushes) lastStart = std::max(lastStart, push.start);
  const double frames = lastStart / frameInterval(scene);
  return scene.camera && frames * static_cast<double>(scene.bodies.size()) <= kMaxWaiting;
}

FilmCamera cameraOf(FilmSource& source, const View& view) {
  return {source.drawnScene(), view.camera, [&source](long number) { return source.drawnFrameAt(number); }};
}

}  // namespace cradle
