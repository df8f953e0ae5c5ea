#include "commands/truth_film.h"

#include <fmt/format.h>

#include <algorithm>

#include "commands/frame_folder.h"
#include "core/error.h"
#include "core/interruption.h"
#include "render/body_place.h"
#include "truth/npy.h"

namespace cradle {

TruthFilm::TruthFilm(TrajectorySource& source, const View& view, int width, int height, const std::vector<Pass>& passes)
    : source_(source),
      width_(width),
      height_(height),
      passes_(passes),
      surfaces_(source.drawnScene(), view),
      camera_(cameraOf(source, view)) {
  const std::size_t bodies = source.scene().bodies.size();
  if (!passes.empty() && bodies >= static_cast<std::size_t>(kFirstLinkId))
    throw Error(ErrorKind::limit, "--passes",
                fmt::format("the scene has {} bodies; a segmentation can tell {} apart", bodies, kFirstLinkId - 1));
}

const Camera& TruthFilm::cameraAt(long frame) {
  while (std::ssize(cameras_) <= frame) {
    throwIfInterrupted();
    cameras_.push_back(camera_.at(source_.drawnFrameAt(std::ssize(cameras_))));
  }
  return cameras_[static_cast<std::size_t>(frame)];
}

bool TruthFilm::has(Pass pass) const {
  return std::find(passes_.begin(), passes_.end(), pass) != passes_.end();
}

FrameRays& TruthFilm::raysOf(long frame) {
  std::unique_ptr<FrameRays>& rays = nearby_[frame];
  if (!rays) {
    const Frame state = source_.drawnFrameAt(frame);
    rays = std::make_unique<FrameRays>(surfaces_, state, placeBodies(source_.drawnScene(), state),
                                       Pinhole(cameraAt(frame), width_, height_));
  }
  return *rays;
}

Pinhole TruthFilm::inSceneWorld(long frame) {
  Camera camera = cameraAt(frame);
  const Quat turn = source_.worldFromDrawn();
  camera.position = turn * camera.position;
  camera.target = turn * camera.target;
  camera.up = turn * camera.up;
  return {camera, width_, height_};
}

std::vector<FileBytes> TruthFilm::filesOf(long frame) {
  std::erase_if(nearby_, [frame](const auto& entry) { return entry.first < frame - 1 || entry.first > frame + 1; });
  FrameRays& seen = raysOf(frame);
  const std::size_t height = static_cast<std::size_t>(height_), width = static_cast<std::size_t>(width_);
  std::vector<FileBytes> files;
  const auto add = [&](const std::string& kind, const auto& numbers, std::size_t channels) {
    std::vector<std::size_t> shape = {height, width};
    if (channels > 1) shape.push_back(channels);
    files.push_back({frameFileName({kind, frame}), npyBytes(numbers, shape)});
  };
  const auto flowTo = [&](long other, bool findsHidden) {
    if (isThere(other)) return flowPass(seen, raysOf(other), findsHidden);
    return Flow{std::vector<float>(2 * height * width, std::numeric_limits<float>::quiet_NaN()),
                std::vector<std::uint8_t>(height * width, 1)};
  };
  const std::vector<std::uint16_t> segmentation = segmentationPass(seen);
  if (has(Pass::depth)) add(nameOf(Pass::depth), depthPass(seen), 1);
  if (has(Pass::normal)) add(nameOf(Pass::normal), normalPass(seen, source_.worldFromDrawn()), 3);
  if (has(Pass::segmentation)) add(nameOf(Pass::segmentation), segmentation, 1);
  if (has(Pass::flow)) {
    const Flow flow = flowTo(frame + 1, true);
    add(nameOf(Pass::flow), flow.shift, 2);
    add(kHiddenKind, flow.isHidden, 1);
  }
  if (has(Pass::backwardFlow)) add(nameOf(Pass::backwardFlow), flowTo(frame - 1, false).shift, 2);
  if (has(Pass::objectCoordinates)) add(nameOf(Pass::objectCoordinates), objectCoordinatesPass(seen), 3);
  std::string instances =
      instancesJson(source_.scene(), source_.frameAt(frame), seen.wholes(), {segmentation, width_, height_});
  files.push_back({frameFileName({kInstancesKind, frame}), std::move(instances)});
  return files;
}

std::vector<FileBytes> TruthFilm::filesOfFilm() {
  std::vector<FrameCamera> cameras;
  for (long frame = 0; frame < source_.frameCount(); ++frame)
    cameras.push_back({frame, frameTime(source_.scene(), frame), inSceneWorld(frame)});
  return {{"camera.json", cameraJson(cameras)},
          {"events.json", eventsJson(source_.reader().events(), source_.scene())}};
}

}  // namespace cradle
