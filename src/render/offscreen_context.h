#pragma once

#include <memory>

namespace cradle {

/// An OpenGL 3.3 core context that needs no screen, with all functions of GLEW loaded. One at a time per thread; it is
/// current from construction on. A program is linked with one of the units in render/contexts, which makes it: OSMesa's
/// draws on the CPU; EGL's, without a surface, also on a GPU.
class OffscreenContext {
 public:
  /// Throws Error(limit) if the driver gives none, or draws nothing.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  /// Makes it current again after another context was used in this thread.
  void makeCurrent();

 private:
  struct Surface;  // what the platform needs
  std::unique_ptr<Surface> surface_;
};

}  // namespace cradle
