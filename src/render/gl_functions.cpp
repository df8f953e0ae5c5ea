// Debian builds GLEW for GLX, the X server's OpenGL, and GLEW asks GLX where functions are. There is no X server here:
// this unit answers in GLX's place and passes the question on to the context. The names must stay visible in the
// executable and stand in the same unit as loadGlFunctions, so that the linker takes them out of the static library.

#include "render/gl_functions.h"

#include <GL/glew.h>

#include <array>
#include <cstdint>
#include <string>

#include "core/error.h"

extern "C" {

void* cradleNoDisplay() {
  static char display = 0;
  return &display;  // GLEW only asks whether there is one
}

cradle::GlFunction glXGetProcAddressARB(const unsigned char* name) {
  const std::string text = reinterpret_cast<const char*>(name);
  if (text == "glXGetCurrentDisplay") return reinterpret_cast<cradle::GlFunction>(cradleNoDisplay);
  if (text.starts_with("glX")) return nullptr;
  return cradle::glFunctionAddress(text.c_str());
}

const char* glXGetClientString(void* /*display*/, int /*name*/) {
  return "";
}

int glXQueryVersion(void* /*display*/, int* major, int* minor) {
  *major = 1;
  *minor = 4;
  return 1;
}

}  // extern "C"

namespace cradle {
namespace {

/// With functions of another library than the context's, OpenGL loads and draws nothing, silently.
void requireDrawing() {
  GLuint target = 0, framebuffer = 0;
  glGenRenderbuffers(1, &target);
  glBindRenderbuffer(GL_RENDERBUFFER, target);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 1, 1);
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target);
  glClearColor(1, 0, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  std::array<std::uint8_t, 4> pixel{};
  glReadPixels(0, 0, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel.data());
  glDeleteFramebuffers(1, &framebuffer);
  glDeleteRenderbuffers(1, &target);
  if (pixel != std::array<std::uint8_t, 4>{255, 0, 255, 255})
    throw Error(ErrorKind::limit, "OpenGL", "does not draw: a pixel that was cleared to magenta reads back otherwise");
}

}  // namespace

void loadGlFunctions() {
  glewExperimental = GL_TRUE;  // else GLEW relies on a list of extensions that core contexts no longer have
  const GLenum result = glewInit();
  if (result != GLEW_OK)
    throw Error(
        ErrorKind::limit, "OpenGL",
        std::string("its functions cannot be loaded: ") + reinterpret_cast<const char*>(glewGetErrorString(result)));
  if (!GLEW_VERSION_3_3) throw Error(ErrorKind::limit, "OpenGL", "version 3.3 is needed");
  requireDrawing();
}

}  // namespace cradle
