#include "commands/truth_film.h"

#include <fmt/format.h>

#include <algorithm>

#include "commands/frame_folder.h"
#include "core/error.h"
#include "core/interruption.h"
#include "render/body_place.h"

namespace cradle {

TruthFilm::TruthFilm(FilmSource& motion, const View& view, int width, int height, const std::vector<Pass>& passes,
                     PassFormat format)
    : motion_(motion),
      width_(width),
      height_(height),
      passes_(passes),
      format_(format),
      surfaces_(motion.drawnScene(), view),
      camera_(cameraOf(motion, view)) {
  const std::size_t bodies = motion.scene().bodies.size();
  if (!passes.empty() && bodies >= static_cast<std::size_t>(kFirstLinkId))
    throw Error(ErrorKind::limit, "--passes",
                fmt::format("the scene has {} bodies; a segmentation can tell {} apart", bodies, kFirstLinkId - 1));
}

const Camera& TruthFilm::cameraAt(long frame) {
  while (std::ssize(cameras_) <= frame) {
    throwIfInterrupted();
    cameras_.push_back(camera_.at(motion_.drawnFrameAt(std::ssize(cameras_))));
  }
  return cameras_[static_cast<std::size_t>(frame)];
}

bool TruthFilm::has(Pass pass) const {
  return std::find(passes_.begin(), passes_.end(), pass) != passes_.end();
}

FrameRays& TruthFilm::raysOf(long frame) {
  std::unique_ptr<FrameRays>& rays = nearby_[frame];
  if (!rays) {
    const Frame state = motion_.drawnFrameAt(frame);
    rays = std::make_unique<FrameRays>(surfaces_, state, placeBodies(motion_.drawnScene(), state),
                                       Pinhole(cameraAt(frame), width_, height_));
  }
  return *rays;
}

Pinhole TruthFilm::inSceneWorld(long frame) {
  Camera camera = cameraAt(frame);
  const Quat turn = motion_.worldFromDrawn();
  camera.position = turn * camera.position;
  camera.target = turn * camera.target;
  camera.up = turn * camera.up;
  return {camera, width_, height_};
}

std::vector<PassArray> TruthFilm::passesOf(long frame, std::vector<std::uint16_t> segmentation) {
  FrameRays& seen = raysOf(frame);
  std::vector<PassArray> arrays;
  const auto add = [&](const std::string& name, int channels, auto numbers) {
    arrays.push_back({name, channels, std::move(numbers)});
  };
  const auto flowTo = [&](long other, bool findsHidden) {
    if (isThere(other)) return flowPass(seen, raysOf(other), findsHidden);
    return Flow{std::vector<float>(2 * segmentation.size(), std::numeric_limits<float>::quiet_NaN()),
                std::vector<std::uint8_t>(segmentation.size(), 1)};
  };
  if (has(Pass::depth)) add(nameOf(Pass::depth), 1, depthPass(seen));
  if (has(Pass::normal)) add(nameOf(Pass::normal), 3, normalPass(seen, motion_.worldFromDrawn()));
  if (has(Pass::flow)) {
    Flow flow = flowTo(frame + 1, true);
    add(nameOf(Pass::flow), 2, std::move(flow.shift));
    add(kHiddenKind, 1, std::move(flow.isHidden));
  }
  if (has(Pass::backwardFlow)) add(nameOf(Pass::backwardFlow), 2, flowTo(frame - 1, false).shift);
  if (has(Pass::objectCoordinates)) add(nameOf(Pass::objectCoordinates), 3, objectCoordinatesPass(seen));
  if (has(Pass::segmentation)) add(nameOf(Pass::segmentation), 1, std::move(segmentation));
  return arrays;
}

std::vector<FileBytes> TruthFilm::filesOf(long frame) {
  std::erase_if(nearby_, [frame](const auto& entry) { return entry.first < frame - 1 || entry.first > frame + 1; });
  const std::vector<std::uint16_t> segmentation = segmentationPass(raysOf(frame));
  const std::vector<PassArray> passes = passesOf(frame, segmentation);
  std::vector<FileBytes> files;
  if (format_ == PassFormat::exr)
    files.push_back({frameFileName({kPassesKind, frame}), exrBytes(passes, width_, height_)});
  else
    for (const PassArray& pass : passes)
      files.push_back({frameFileName({pass.name, frame}), npyBytes(pass, width_, height_)});
  std::string instances =
      instancesJson(motion_.scene(), motion_.frameAt(frame), raysOf(frame).wholes(), {segmentation, width_, height_});
  files.push_back({frameFileName({kInstancesKind, frame}), std::move(instances)});
  return files;
}

std::vector<FileBytes> TruthFilm::filesOfFilm() {
  std::vector<FrameCamera> cameras;
  for (long frame = 0; frame < motion_.frameCount(); ++frame)
    cameras.push_back({frame, frameTime(motion_.scene(), frame), inSceneWorld(frame)});
  return {{kCameraFile, cameraJson(cameras)}, {kEventsFile, eventsJson(motion_.reader().events(), motion_.scene())}};
}

}  // namespace cradle
