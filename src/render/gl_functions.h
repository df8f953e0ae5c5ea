#pragma once

namespace cradle {

using GlFunction = void (*)();

/// OpenGL's function of this name, or null. Each kind of context has its own answer, in render/contexts.
GlFunction glFunctionAddress(const char* name);

/// Loads OpenGL's functions into GLEW for the context that is current, and draws a pixel with them. Throws Error(limit)
/// if GLEW cannot, or nothing is drawn.
void loadGlFunctions();

}  // namespace cradle
