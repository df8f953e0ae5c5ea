#include "film/drawing_memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <fstream>

#include "core/error.h"

namespace cradle {
namespace {

constexpr std::uint64_t kForPixel = 64;  // bytes; 44 have been seen

/// A limit of the shell that Mesa, or the compiler of shaders behind it, crashes at.
struct MemoryLimit {
  __rlimit_resource resource;
  const char* name;
  std::size_t field;         // of /proc/self/statm: pages that count
  std::uint64_t forDrawing;  // bytes, beside those of the pixels
};

// Measured with Mesa 22.3 (llvmpipe, LLVM 15), beyond what the program has before it opens them. Address space: 570 MB
// crash, 620 MB cannot draw 1280x720, 670 MB can; 3840x2160 need 300 MB more. Data, which libraries that are only read
// do not count to: 130 MB crash at 1280x720, 150 MB do not.
constexpr std::array<MemoryLimit, 2> kLimits = {
    {{RLIMIT_AS, "address space (ulimit -v)", 0, 680 << 20}, {RLIMIT_DATA, "data (ulimit -d)", 5, 150 << 20}}};

std::uint64_t usedBytes(std::size_t field) {
  std::array<std::uint64_t, 7> pages{};
  std::ifstream file("/proc/self/statm");
  for (std::uint64_t& number : pages) file >> number;
  return pages[field] * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void requireMemory(const MemoryLimit& limit, int width, int height) {
  rlimit limits{};
  if (getrlimit(limit.resource, &limits) != 0 || limits.rlim_cur == RLIM_INFINITY) return;
  const std::uint64_t used = usedBytes(limit.field), left = limits.rlim_cur > used ? limits.rlim_cur - used : 0;
  const std::uint64_t needed =
      limit.forDrawing + kForPixel * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  if (left >= needed) return;
  throw Error(ErrorKind::limit, "",
              fmt::format("the limit on {} leaves {} MB, and pictures of {}x{} need {} MB; raise it, or draw smaller "
                          "ones",
                          limit.name, left >> 20, width, height, needed >> 20));
}

}  // namespace

void requireDrawingMemory(int width, int height) {
  for (const MemoryLimit& limit : kLimits) requireMemory(limit, width, height);
}

}  // namespace cradle
