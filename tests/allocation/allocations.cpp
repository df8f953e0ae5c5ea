#include "allocation/allocations.h"

#include <atomic>
#include <cstddef>

namespace {
std::atomic<long> calls{0};
}

extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* malloc(std::size_t size) {
  ++calls;
  return __libc_malloc(size);
}

namespace cradle {

long allocations() {
  return calls;
}

}  // namespace cradle
