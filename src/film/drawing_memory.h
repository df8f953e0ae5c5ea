#pragma once

namespace cradle {

/// Throws Error(limit) where a limit on this process's address space or data (ulimit -v, -d) leaves too little to draw
/// pictures of that size: Mesa, and the compiler of shaders behind it, crash where they get no memory.
void requireDrawingMemory(int width, int height);  // pixels

}  // namespace cradle
