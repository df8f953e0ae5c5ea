#pragma once

#include <memory>
#include <string>

#include "image/image.h"
#include "render/changed_area.h"
#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Seconds that the passes of a picture took.
struct RenderTimes {
  double drawList = 0;
  double maps = 0;  // shadows and contact shadows
  double main = 0;
  double resolve = 0;
  double readBack = 0;
};

/// Draws the frames of one film, each as far as it differs from the one before. A picture depends on scene, view, size
/// and frame alone: not on pictures drawn before, nor on the number of threads. One renderer at a time per thread.
class Renderer {
 public:
  /// Sizes in pixels. `shaderFolder` replaces the shaders that are built in, unless empty. The scene must outlive the
  /// renderer. Throws Error(limit) for sizes or memory that cannot be had, Error(usage) for shaders that do not
  /// compile.
  Renderer(const Scene& scene, const View& view, int width, int height, const std::string& shaderFolder = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Draws what differs from the picture before, and copies the rest. Without a camera, from where the film begins.
  Image render(const Frame& frame, const Camera& camera);
  Image render(const Frame& frame) { return render(frame, view_.camera); }

  /// The next picture is drawn whole.
  void forgetPicture();

  /// Share of the latest picture that was drawn rather than copied, 0..1.
  double drawnShare() const { return drawnShare_; }

  /// Of the latest picture. Each pass waits for OpenGL to finish only if `measuring` was set.
  const RenderTimes& times() const { return times_; }
  void measurePasses(bool measuring) { measuring_ = measuring; }

 private:
  struct Programs;
  struct Resources;
  void aim(const Camera& camera, const DrawList& list);
  void moveMaps();
  void draw(const DrawList& list, const ChangedArea& changed);
  void drawPicture(const PixelRectangle& area);
  void finishPass(double& seconds);

  const Scene& scene_;
  const View view_;
  std::unique_ptr<Resources> resources_;
  RenderTimes times_;
  double drawnShare_ = 0;
  bool measuring_ = false;
};

}  // namespace cradle
