#pragma once

namespace cradle {

/// Loads OpenGL's functions into GLEW for the context that is current. Throws Error(limit) if GLEW cannot.
void loadGlFunctions();

}  // namespace cradle
