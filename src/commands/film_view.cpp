#include "commands/film_view.h"

#include <algorithm>

namespace cradle {

View viewOf(TrajectorySource& source, int width, int height) {
  std::vector<ShownPush> pushes;
  if (source.isWhole())
    pushes = findShownPushes(source.scene(), source.reader().events(), [&source](long frame) {
      return source.frameAt(std::min(frame, source.frameCount() - 1));
    });
  Framing framing(source.scene(), width, height, std::move(pushes));
  const long frames = source.scene().camera ? 1 : source.frameCount();
  for (long number = 0; number < frames; ++number) framing.add(source.frameAt(number));
  return framing.view();
}

bool isSeenFromTheStart(const Scene& scene) {
  return scene.camera && scene.pushes.empty();
}

FilmCamera cameraOf(TrajectorySource& source, const View& view) {
  return {source.scene(), view.camera, [&source](long number) { return source.frameAt(number); }};
}

}  // namespace cradle
