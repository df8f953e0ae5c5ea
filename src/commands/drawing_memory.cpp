#include "commands/drawing_memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>

#include "core/error.h"

namespace cradle {
namespace {

// Measured with Mesa 22.3 (llvmpipe, LLVM 15), beyond what the program has before it opens them: 570 MB crash, 620 MB
// cannot draw 1280x720, 670 MB can; 3840x2160 need 300 MB more, 44 bytes a pixel.
constexpr std::uint64_t kForDrawing = 680 << 20;  // bytes
constexpr std::uint64_t kForPixel = 64;           // bytes

std::uint64_t addressSpaceOfProcess() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;  // first number: program size
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

void requireDrawingMemory(int width, int height) {
  rlimit limits{};
  if (getrlimit(RLIMIT_AS, &limits) != 0 || limits.rlim_cur == RLIM_INFINITY) return;
  const std::uint64_t used = addressSpaceOfProcess(), left = limits.rlim_cur > used ? limits.rlim_cur - used : 0;
  const std::uint64_t needed =
      kForDrawing + kForPixel * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (left >= needed) return;
  throw Error(
      ErrorKind::limit, "",
      fmt::format("the limit on address space (ulimit -v) leaves {} MB, and pictures of {}x{} need {} MB; raise "
                  "it, or draw smaller ones",
                  left >> 20, width, height, needed >> 20));
}

}  // namespace cradle
