#include "render/offscreen_context.h"

#include <GL/glew.h>
#define GLAPI extern
#include <GL/osmesa.h>

#include <array>
#include <cstdint>

#include "core/error.h"
#include "render/gl_functions.h"

namespace cradle {

struct OffscreenContext::Surface {
  static constexpr int kSize = 16;  // pixels; pictures are drawn into framebuffer objects, not here

  OSMesaContext context = nullptr;
  std::array<std::uint8_t, 4 * kSize * kSize> pixels{};

  ~Surface() {
    if (context != nullptr) OSMesaDestroyContext(context);
  }
};

namespace {

/// Linked in the wrong order, OpenGL loads and draws nothing, silently.
void requireDrawing() {
  if (glGetString(GL_VERSION) == nullptr) throw Error(ErrorKind::limit, "OpenGL", "has no version: not usable here");
  glClearColor(1, 0, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  std::array<std::uint8_t, 4> pixel{};
  glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
  if (pixel != std::array<std::uint8_t, 4>{255, 0, 255, 255})
    throw Error(ErrorKind::limit, "OpenGL", "does not draw: a pixel that was cleared to magenta reads back otherwise");
}

}  // namespace

OffscreenContext::OffscreenContext() : surface_(std::make_unique<Surface>()) {
  const std::array<int, 11> attributes = {OSMESA_FORMAT,
                                          OSMESA_RGBA,
                                          OSMESA_PROFILE,
                                          OSMESA_CORE_PROFILE,
                                          OSMESA_CONTEXT_MAJOR_VERSION,
                                          3,
                                          OSMESA_CONTEXT_MINOR_VERSION,
                                          3,
                                          OSMESA_DEPTH_BITS,
                                          0,
                                          0};
  surface_->context = OSMesaCreateContextAttribs(attributes.data(), nullptr);
  if (surface_->context == nullptr)
    throw Error(ErrorKind::limit, "OpenGL", "OSMesa gives no context of version 3.3; install libosmesa6");
  makeCurrent();
  loadGlFunctions();
  requireDrawing();
}

OffscreenContext::~OffscreenContext() = default;

void OffscreenContext::makeCurrent() {
  if (OSMesaMakeCurrent(surface_->context, surface_->pixels.data(), GL_UNSIGNED_BYTE, Surface::kSize, Surface::kSize) !=
      GL_TRUE)
    throw Error(ErrorKind::limit, "OpenGL", "OSMesa's context cannot be made current");
}

}  // namespace cradle
