// EGL without a surface, as EGL_MESA_platform_surfaceless and EGL_KHR_surfaceless_context describe it.

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>

#include "core/error.h"
#include "render/gl_functions.h"
#include "render/offscreen_context.h"

namespace cradle {

struct OffscreenContext::Surface {
  EGLDisplay display = EGL_NO_DISPLAY;  // the process has one, which all contexts share: it is never terminated
  EGLContext context = EGL_NO_CONTEXT;

  ~Surface() {
    if (context == EGL_NO_CONTEXT) return;
    if (eglGetCurrentContext() == context) eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
  }
};

namespace {

[[noreturn]] void fail(const char* what) {
  throw Error(ErrorKind::limit, "OpenGL", std::string(what) + "; install libegl1 and libgl1-mesa-dri");
}

}  // namespace

OffscreenContext::OffscreenContext() : surface_(std::make_unique<Surface>()) {
  surface_->display = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (surface_->display == EGL_NO_DISPLAY || eglInitialize(surface_->display, nullptr, nullptr) != EGL_TRUE)
    fail("EGL has no display without a screen");
  eglBindAPI(EGL_OPENGL_API);
  const std::array<EGLint, 7> attributes = {
      EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  surface_->context = eglCreateContext(surface_->display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
  if (surface_->context == EGL_NO_CONTEXT) fail("EGL gives no context of version 3.3");
  makeCurrent();
  loadGlFunctions();
}

OffscreenContext::~OffscreenContext() = default;

void OffscreenContext::makeCurrent() {
  eglBindAPI(EGL_OPENGL_API);
  if (eglMakeCurrent(surface_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, surface_->context) != EGL_TRUE)
    fail("EGL's context cannot be made current");
}

GlFunction glFunctionAddress(const char* name) {
  return reinterpret_cast<GlFunction>(eglGetProcAddress(name));
}

}  // namespace cradle
