#pragma once

#include <stdlib.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"

// What the targets of libFuzzer have in common: bytes of a stranger are refused by an Error, or what they become holds.

namespace cradle {

/// Ends the fuzzer, which keeps the input, unless something holds of what was accepted.
#define HOLDS(condition) \
  if (!(condition)) std::fprintf(stderr, "does not hold: %s (%s:%d)\n", #condition, __FILE__, __LINE__), std::abort()

inline std::string textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// Runs `work`. An Error is a refusal, which has a message; all else that is thrown ends the fuzzer.
template <class Work>
void acceptOrRefuse(const Work& work) {
  try {
    work();
  } catch (const Error& error) {
    HOLDS(error.what()[0] != '\0');
  }
}

/// A file with a name, for readers that want one; gone with the process.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& name) {
    std::string pattern = (std::filesystem::temp_directory_path() / "cradle_fuzz_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    path_ = folder_ + "/" + name;
  }
  ~ScratchFile() { std::filesystem::remove_all(folder_); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& folder() const { return folder_; }
  void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }

 private:
  std::string folder_, path_;
};

}  // namespace cradle
