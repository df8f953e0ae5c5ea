// Debian builds GLEW for GLX, the X server's OpenGL, and GLEW asks GLX where functions are. There is no X server here:
// this unit answers in GLX's place and passes the question on to OSMesa. The names must stay visible in the executable
// and stand in the same unit as loadGlFunctions, so that the linker takes them out of the static library.

#include "render/gl_functions.h"

#include <GL/glew.h>
#define GLAPI extern
#include <GL/osmesa.h>

#include <string>

#include "core/error.h"

extern "C" {

void* cradleNoDisplay() {
  static char display = 0;
  return &display;  // GLEW only asks whether there is one
}

using GlxFunction = void (*)();

GlxFunction glXGetProcAddressARB(const unsigned char* name) {
  const std::string text = reinterpret_cast<const char*>(name);
  if (text == "glXGetCurrentDisplay") return reinterpret_cast<GlxFunction>(cradleNoDisplay);
  if (text.starts_with("glX")) return nullptr;
  return reinterpret_cast<GlxFunction>(OSMesaGetProcAddress(text.c_str()));
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

void loadGlFunctions() {
  glewExperimental = GL_TRUE;  // else GLEW relies on a list of extensions that core contexts no longer have
  const GLenum result = glewInit();
  if (result != GLEW_OK)
    throw Error(
        ErrorKind::limit, "OpenGL",
        std::string("its functions cannot be loaded: ") + reinterpret_cast<const char*>(glewGetErrorString(result)));
  if (!GLEW_VERSION_3_3) throw Error(ErrorKind::limit, "OpenGL", "version 3.3 is needed; install libosmesa6");
}

}  // namespace cradle
