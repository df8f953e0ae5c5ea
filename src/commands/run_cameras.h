#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "render/camera_path.h"
#include "render/framing.h"

namespace cradle {

/// The cameras of pictures of a scene's size, from a run under way. One that the scene names is known with each frame,
/// one that is chosen after the last, from the whole motion; none of a scene with many pushes, or with pushes of so
/// many bodies that their frames cannot be kept.
class RunCameras {
 public:
  /// Keeps a reference to `scene`. `tell` gets each camera.
  RunCameras(const Scene& scene, std::function<void(const CameraPose&)> tell);
  RunCameras(const RunCameras&) = delete;
  RunCameras& operator=(const RunCameras&) = delete;

  /// Events and frames in the order of time.
  void note(const Event& event);
  void note(const Frame& frame);

  /// After the last frame.
  void finish();

 private:
  void noteDrawn(const Frame& frame);
  void keep(const Frame& frame);
  void tell(long frame, const Camera& camera) const;

  const Scene& scene_;
  const std::function<void(const CameraPose&)> tell_;
  const Quat drawnFromWorld_;
  std::optional<Scene> upright_;  // the drawn one, if it is another
  std::optional<CameraPath> path_;
  std::optional<Framing> framing_;  // of a chosen camera; where pushes are shown only after the last frame
  std::vector<Event> pushes_;
  std::vector<Frame> frames_;  // drawn, if pushes are shown
  bool keepsFrames_ = true;
  long count_ = 0;
};

}  // namespace cradle
