#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace cradle {

struct ChildLimits {
  std::uint64_t memory;      // bytes, beyond what this process has, until the child calls limitMemory
  std::uint64_t mostMemory;  // bytes, that it may ask for there
  std::uint64_t cpuSeconds;  // s
};

struct ChildAnswer {
  std::string bytes;    // what the work returned
  std::string failure;  // why it did not return, as the end of "cannot be read as a mesh: "; empty if it did
};

/// Runs `work` in a child process, for code that believes what a damaged file says: it may crash, never return, or
/// reserve 48 GB for a count in 200 bytes. The child has no files of this process open, and can only open files for
/// reading: not change any, start no processes, reach no network. What it answers is as trustworthy as the file. An
/// Error of the work is thrown here. Throws Error(limit) if no process can be started.
ChildAnswer answerOfChild(const std::function<std::string()>& work, const ChildLimits& limits);

/// In the child: from here on it may have so many bytes. Elsewhere nothing.
void limitMemory(std::uint64_t bytes);

}  // namespace cradle
