#include "core/large_array.h"

#include <sys/mman.h>

#include <new>

namespace cradle {
namespace {

constexpr std::size_t kLine = 64;            // bytes, of caches
constexpr std::size_t kHugePage = 2 << 20;   // bytes, on x86-64

std::align_val_t alignmentOf(std::size_t bytes) {
  return std::align_val_t(bytes < kHugePage ? kLine : kHugePage);
}

}  // namespace

void* allocateLarge(std::size_t bytes) {
  void* memory = ::operator new(bytes, alignmentOf(bytes));
  if (bytes >= kHugePage) madvise(memory, bytes, MADV_HUGEPAGE);  // refused, it is memory all the same
  return memory;
}

void freeLarge(void* memory, std::size_t bytes) {
  ::operator delete(memory, alignmentOf(bytes));
}

}  // namespace cradle
