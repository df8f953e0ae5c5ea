#pragma once

#include <sys/resource.h>

#include <cstdint>

namespace cradle {

/// While it lives, the process may reserve only `bytes` more memory than it has; beyond that `new` throws
/// std::bad_alloc. For code that believes the counts in a file: a few bytes can ask for 96 GiB.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::uint64_t bytes);
  ~MemoryLimit();
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  rlimit before_{};
};

}  // namespace cradle
