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
  if (waiting_.size() + bytes.size() > kMaxWaiting) flush();
  if (bytes.size() > kMaxWaiting)
    put(bytes);  // as it stands, without a copy
  else
    waiting_ += bytes;
}

void PartFile::complete() {
  flush();
  lock_.finish();
}

void PartFile::flush() {
  put(waiting_);
  waiting_.clear();
}

void PartFile::put(std::string_view bytes) {
  for (std::size_t written = 0; written < bytes.size();) {
    const ssize_t length = ::write(lock_.file(), bytes.data() + written, bytes.size() - written);
    if (length < 0 && errno == EINTR) continue;
    if (length < 0) throw Error(ErrorKind::output, path_, fmt::format("cannot be written: {}", std::strerror(errno)));
    written += static_cast<std::size_t>(length);
  }
}

void writeWholeFile(const std::string& path, std::string_view bytes) {
  PartFile file(path);
  file.write(bytes);
  file.complete();
}

}  // namespace cradle
