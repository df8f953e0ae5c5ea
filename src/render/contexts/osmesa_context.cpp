#include <GL/glew.h>
#define GLAPI extern
#include <GL/osmesa.h>
#include <dlfcn.h>

#include <array>
#include <cstdint>
#include <string>

#include "core/error.h"
#include "render/gl_functions.h"
#include "render/offscreen_context.h"

namespace cradle {
namespace {

/// The functions of libOSMesa that are used. It is opened with the first context: to load it, with the compiler of
/// shaders that it needs, takes 0.09 s of CPU time, for which commands that draw nothing would wait as well.
class OsMesa {
 public:
  static const OsMesa& library() {
    static const OsMesa opened;  // never closed: Mesa leaves handlers behind for the end of the process
    return opened;
  }

  decltype(&OSMesaCreateContextAttribs) createContextAttribs;
  decltype(&OSMesaDestroyContext) destroyContext;
  decltype(&OSMesaMakeCurrent) makeCurrent;
  decltype(&OSMesaGetProcAddress) getProcAddress;

 private:
  OsMesa() : handle_(dlopen("libOSMesa.so.8", RTLD_LAZY | RTLD_LOCAL)) {
    if (handle_ == nullptr) fail();
    find("OSMesaCreateContextAttribs", createContextAttribs);
    find("OSMesaDestroyContext", destroyContext);
    find("OSMesaMakeCurrent", makeCurrent);
    find("OSMesaGetProcAddress", getProcAddress);
  }

  template <class Function>
  void find(const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(dlsym(handle_, name));
    if (function == nullptr) fail();
  }

  [[noreturn]] static void fail() {
    throw Error(ErrorKind::limit, "OpenGL", std::string(dlerror()) + "; install libosmesa6");
  }

  void* handle_;
};

}  // namespace

struct OffscreenContext::Surface {
  static constexpr int kSize = 16;  // pixels; pictures are drawn into framebuffer objects, not here

  OSMesaContext context = nullptr;
  std::array<std::uint8_t, 4 * kSize * kSize> pixels{};

  ~Surface() {
    if (context != nullptr) OsMesa::library().destroyContext(context);
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
  surface_->context = OsMesa::library().createContextAttribs(attributes.data(), nullptr);
  if (surface_->context == nullptr)
    throw Error(ErrorKind::limit, "OpenGL", "OSMesa gives no context of version 3.3; install libosmesa6");
  makeCurrent();
  loadGlFunctions();
}

OffscreenContext::~OffscreenContext() = default;

void OffscreenContext::makeCurrent() {
  if (OsMesa::library().makeCurrent(surface_->context, surface_->pixels.data(), GL_UNSIGNED_BYTE, Surface::kSize,
                                    Surface::kSize) != GL_TRUE)
    throw Error(ErrorKind::limit, "OpenGL", "OSMesa's context cannot be made current");
}

GlFunction glFunctionAddress(const char* name) {
  return reinterpret_cast<GlFunction>(OsMesa::library().getProcAddress(name));
}

}  // namespace cradle
