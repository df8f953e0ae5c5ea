#include "commands/film_view.h"

#include <algorithm>

#include "render/body_place.h"
#include "render/camera_path.h"

namespace cradle {

View viewOf(const TrajectorySource& source, int width, int height) {
  const TrajectoryReader& reader = source.reader();
  const auto pushes = findShownPushes(source.scene(), reader.events(), [&reader](long frame) {
    return reader.readFrame(std::min(frame, reader.frameCount() - 1));
  });
  Framing framing(source.scene(), width, height, pushes);
  std::vector<Camera> cameras;
  std::optional<CameraPath> path;
  if (source.scene().camera) path.emplace(source.scene());
  for (long number = 0; number < reader.frameCount(); ++number) {
    const Frame frame = reader.readFrame(number);
    framing.add(frame);
    if (path) cameras.push_back(path->next(frame.time, placeBodies(source.scene(), frame)));
  }
  View view = framing.view();
  if (!source.scene().cameraMotion.isNone()) {
    view.camera = cameras.front();
    view.cameras = std::move(cameras);
  }
  return view;
}

}  // namespace cradle
