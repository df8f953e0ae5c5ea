#include "core/console.h"

#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/printable.h"

namespace cradle {
namespace {

/// Nobody reads any more: what came through was what the reader wanted.
void requireOutput(bool isWritten) {
  if (isWritten || errno == EPIPE) return;
  throw Error(ErrorKind::output, "standard output", fmt::format("cannot be written: {}", std::strerror(errno)));
}

}  // namespace

void showText(std::FILE* file, std::string_view text) {
  const std::string shown = printable(text);
  const bool isWritten = std::fwrite(shown.data(), 1, shown.size(), file) == shown.size();
  if (file == stdout) requireOutput(isWritten);
}

void flushOutput() {
  requireOutput(std::fflush(stdout) == 0);
}

}  // namespace cradle
