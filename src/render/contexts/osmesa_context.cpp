#include <GL/glew.h>
#define GLAPI extern
#include <GL/osmesa.h>

#include <array>
#include <cstdint>

#include "core/error.h"
#include "render/gl_functions.h"
#include "render/offscreen_context.h"

namespace cradle {

struct OffscreenContext::Surface {
  static constexpr int kSize = 16;  // pixels; pictures are drawn into framebuffer objects, not here

  OSMesaContext context = nullptr;
  std::array<std::uint8_t, 4 * kSize * kSize> pixels{};

  ~Surface() {
    if (context != nullptr) OSMesaDestroyContext(context);
  }
};

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
}

OffscreenContext::~OffscreenContext() = default;

void OffscreenContext::makeCurrent() {
  if (OSMesaMakeCurrent(surface_->context, surface_->pixels.data(), GL_UNSIGNED_BYTE, Surface::kSize, Surface::kSize) !=
      GL_TRUE)
    throw Error(ErrorKind::limit, "OpenGL", "OSMesa's context cannot be made current");
}

GlFunction glFunctionAddress(const char* name) {
  return reinterpret_cast<GlFunction>(OSMesaGetProcAddress(name));
}

}  // namespace cradle
