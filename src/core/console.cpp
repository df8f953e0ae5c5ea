#include "core/console.h"

#include <fcntl.h>
#include <unistd.h>

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

void fillStandardFiles() {
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(file, F_GETFD) >= 0) continue;
    if (open("/dev/null", O_RDONLY) < 0) return;  // else it gets the least number that is free: this one
  }
}

void showText(std::FILE* file, std::string_view text) {
  const std::string shown = printable(text);
  const bool isWritten = std::fwrite(shown.data(), 1, shown.size(), file) == shown.size();
  if (file == stdout) requireOutput(isWritten);
}

void flushOutput() {
  requireOutput(std::fflush(stdout) == 0);
}

}  // namespace cradle
