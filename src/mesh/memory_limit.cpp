#include "mesh/memory_limit.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "core/error.h"

namespace cradle {
namespace {

std::uint64_t addressSpaceInUse() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;  // first number: program size
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace

MemoryLimit::MemoryLimit(std::uint64_t bytes) {
  CRADLE_CHECK(getrlimit(RLIMIT_AS, &before_) == 0);
  const std::uint64_t used = addressSpaceInUse();
  if (used == 0) return;  // no /proc: no limit
  rlimit limited = before_;
  limited.rlim_cur = std::min<rlim_t>(before_.rlim_cur, used + bytes);
  CRADLE_CHECK(setrlimit(RLIMIT_AS, &limited) == 0);
}

MemoryLimit::~MemoryLimit() {
  setrlimit(RLIMIT_AS, &before_);
}

}  // namespace cradle
