#include "core/part_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace cradle {
namespace {

constexpr std::size_t kMaxWaiting = 1 << 16;  // bytes

}  // namespace

void PartFile::write(std::string_view bytes) {
  waiting_ += bytes;
  if (waiting_.size() > kMaxWaiting) flush();
}

void PartFile::complete() {
  flush();
  lock_.finish();
}

void PartFile::flush() {
  for (std::size_t written = 0; written < waiting_.size();) {
    const ssize_t length = ::write(lock_.file(), waiting_.data() + written, waiting_.size() - written);
    if (length < 0 && errno == EINTR) continue;
    if (length < 0) throw Error(ErrorKind::output, path_, fmt::format("cannot be written: {}", std::strerror(errno)));
    written += static_cast<std::size_t>(length);
  }
  waiting_.clear();
}

void writeWholeFile(const std::string& path, std::string_view bytes) {
  PartFile file(path);
  file.write(bytes);
  file.complete();
}

}  // namespace cradle
