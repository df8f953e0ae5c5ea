#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace cradle {

struct TrialLimits {
  std::uint64_t memory;      // bytes, beyond what this process has
  std::uint64_t cpuSeconds;  // s
};

/// Runs `work` in a child process first, for code that believes what a damaged file says: it may crash, never return,
/// or reserve 48 GB for a count in 200 bytes. Returns what `work` returned, or a sentence if it did not return. Throws
/// Error(limit) if no process can be started.
std::string tryInChild(const std::function<std::string()>& work, const TrialLimits& limits);

}  // namespace cradle
