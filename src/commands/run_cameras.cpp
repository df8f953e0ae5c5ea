#include "commands/run_cameras.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "render/body_place.h"
#include "render/upright.h"
#include "scene/camera_axes.h"

namespace cradle {
namespace {

constexpr std::size_t kMostPushes = 256;  // each asks for the length of each other's arrow in each frame that shows it
constexpr std::size_t kMostStates = 1'000'000;  // that are kept, 0.1 GB

}  // namespace

RunCameras::RunCameras(const Scene& scene, std::function<void(const CameraPose&)> tell)
    : scene_(scene), tell_(std::move(tell)), drawnFromWorld_(uprightFromWorld(scene)) {
  if (upOf(scene) != Vec3::UnitY()) upright_ = turned(drawnFromWorld_, scene);
  const Scene& drawn = upright_ ? *upright_ : scene_;
  if (drawn.camera)
    path_.emplace(drawn);
  else if (drawn.pushes.empty())
    framing_.emplace(drawn, drawn.output.width, drawn.output.height);
}

void RunCameras::note(const Event& event) {
  if (event.kind == EventKind::pushStart || event.kind == EventKind::pushMissed)
    pushes_.push_back(upright_ ? turned(drawnFromWorld_, event) : event);
}

void RunCameras::note(const Frame& frame) {
  ++count_;
  if (!upright_) return noteDrawn(frame);
  noteDrawn(turned(drawnFromWorld_, frame));
}

void RunCameras::noteDrawn(const Frame& frame) {
  if (framing_) return framing_->add(frame);
  if (!scene_.camera) return keep(frame);
  if (!path_) return;
  try {
    tell(frame.number, path_->next(frame.time, placeBodies(upright_ ? *upright_ : scene_, frame)));
  } catch (const Error&) {  // no pictures are drawn from there on
    path_.reset();
  }
}

void RunCameras::keep(const Frame& frame) {
  const std::size_t states = static_cast<std::size_t>(count_) * frame.states.size();
  keepsFrames_ = keepsFrames_ && scene_.pushes.size() <= kMostPushes && states <= kMostStates;
  if (!keepsFrames_) return frames_.clear();
  frames_.push_back(frame);
  frames_.back().contacts = {};
}

void RunCameras::finish() {
  if (scene_.camera || count_ == 0 || !keepsFrames_) return;
  const Scene& drawn = upright_ ? *upright_ : scene_;
  if (!framing_) {
    const auto frameAt = [this](long number) {
      return frames_[static_cast<std::size_t>(std::min(number, count_ - 1))];
    };
    framing_.emplace(drawn, drawn.output.width, drawn.output.height, findShownPushes(drawn, pushes_, frameAt));
    for (const Frame& frame : frames_) framing_->add(frame);
  }
  const Camera camera = framing_->view().camera;
  for (long frame = 0; frame < count_; ++frame) tell(frame, camera);
}

void RunCameras::tell(long frame, const Camera& camera) const {
  if (!isPossiblePlace(camera.position)) return;
  const Quat worldFromDrawn = drawnFromWorld_.conjugate();
  const Quat orientation = Quat(Mat3(worldFromDrawn * cameraAxes(camera))).normalized();
  tell_({frame, worldFromDrawn * camera.position, orientation, camera.verticalFieldOfView});
}

}  // namespace cradle
