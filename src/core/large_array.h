#pragma once

#include <cstddef>
#include <vector>

namespace cradle {

/// Memory for `bytes`, aligned to 64; from 2 MiB on in huge pages, where the system grants them. Throws std::bad_alloc.
void* allocateLarge(std::size_t bytes);
/// Gives it back; the same `bytes`.
void freeLarge(void* memory, std::size_t bytes);

template <class T>
struct LargeAllocator {
  using value_type = T;
  LargeAllocator() = default;
  template <class Other>
  LargeAllocator(const LargeAllocator<Other>&) {}
  T* allocate(std::size_t count) { return static_cast<T*>(allocateLarge(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) { freeLarge(memory, count * sizeof(T)); }
  bool operator==(const LargeAllocator&) const { return true; }
};

/// For megabytes that are gone through in any order: each step of such a way would else ask for another small page, of
/// which the processor has only so many at hand. In heaps of 5000 bodies that is a tenth of the time.
template <class T>
using LargeArray = std::vector<T, LargeAllocator<T>>;

}  // namespace cradle
