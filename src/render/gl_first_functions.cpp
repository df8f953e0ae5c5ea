// The functions of OpenGL 1.1 that render calls. GLEW declares them and leaves them to the linker, since a system's
// OpenGL library has them by name; here that library is opened only when something is drawn (render/contexts), so that
// each passes its arguments on to the context's function. The linker names one that is missing here.

#include <GL/glew.h>

#include "core/error.h"
#include "render/gl_functions.h"

namespace {

/// Calls the function of this name that the context has. It serves all contexts of a process.
template <auto* declared, class... Arguments>
void call(const char* name, Arguments... arguments) {
  static const auto function = reinterpret_cast<decltype(declared)>(cradle::glFunctionAddress(name));
  CRADLE_CHECK(function != nullptr);
  function(arguments...);
}

}  // namespace

extern "C" {

void glBindTexture(GLenum target, GLuint texture) {
  call<glBindTexture>("glBindTexture", target, texture);
}

void glBlendFunc(GLenum source, GLenum destination) {
  call<glBlendFunc>("glBlendFunc", source, destination);
}

void glClear(GLbitfield buffers) {
  call<glClear>("glClear", buffers);
}

void glClearColor(GLclampf red, GLclampf green, GLclampf blue, GLclampf alpha) {
  call<glClearColor>("glClearColor", red, green, blue, alpha);
}

void glDeleteTextures(GLsizei count, const GLuint* textures) {
  call<glDeleteTextures>("glDeleteTextures", count, textures);
}

void glDepthFunc(GLenum comparison) {
  call<glDepthFunc>("glDepthFunc", comparison);
}

void glDepthMask(GLboolean isWritten) {
  call<glDepthMask>("glDepthMask", isWritten);
}

void glDisable(GLenum capability) {
  call<glDisable>("glDisable", capability);
}

void glDrawBuffer(GLenum buffer) {
  call<glDrawBuffer>("glDrawBuffer", buffer);
}

void glDrawElements(GLenum mode, GLsizei count, GLenum type, const void* indices) {
  call<glDrawElements>("glDrawElements", mode, count, type, indices);
}

void glEnable(GLenum capability) {
  call<glEnable>("glEnable", capability);
}

void glFinish() {
  call<glFinish>("glFinish");
}

void glGenTextures(GLsizei count, GLuint* textures) {
  call<glGenTextures>("glGenTextures", count, textures);
}

void glGetIntegerv(GLenum name, GLint* values) {
  call<glGetIntegerv>("glGetIntegerv", name, values);
}

void glPixelStorei(GLenum name, GLint value) {
  call<glPixelStorei>("glPixelStorei", name, value);
}

void glReadBuffer(GLenum buffer) {
  call<glReadBuffer>("glReadBuffer", buffer);
}

void glReadPixels(GLint x, GLint y, GLsizei width, GLsizei height, GLenum format, GLenum type, void* pixels) {
  call<glReadPixels>("glReadPixels", x, y, width, height, format, type, pixels);
}

void glScissor(GLint x, GLint y, GLsizei width, GLsizei height) {
  call<glScissor>("glScissor", x, y, width, height);
}

void glTexImage2D(GLenum target, GLint level, GLint internalFormat, GLsizei width, GLsizei height, GLint border,
                  GLenum format, GLenum type, const void* pixels) {
  call<glTexImage2D>("glTexImage2D", target, level, internalFormat, width, height, border, format, type, pixels);
}

void glTexParameteri(GLenum target, GLenum name, GLint value) {
  call<glTexParameteri>("glTexParameteri", target, name, value);
}

void glViewport(GLint x, GLint y, GLsizei width, GLsizei height) {
  call<glViewport>("glViewport", x, y, width, height);
}

}  // extern "C"
