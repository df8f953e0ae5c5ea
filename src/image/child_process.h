#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/crash.h"
#include "core/error.h"

namespace cradle {

/// What it means that a program cannot be started, and the Debian package that has it.
struct StartFailure {
  ErrorKind kind = ErrorKind::encoder;
  const char* package = "ffmpeg";
};

/// How long a program may do nothing (take no bytes and next to no processor time) before it counts as hanging.
constexpr std::chrono::milliseconds kChildPatience{60'000};

/// Another program, started without a shell, that reads what is written to it. What it prints is kept. It is ended,
/// with all that it has started, when the object goes before finish(). It does not hear the terminal's Ctrl-C: the
/// owner decides when it ends, and waiting for it throws as throwIfInterrupted() does.
class ChildProcess {
 public:
  /// command[0] is looked up in PATH. Throws Error(failure.kind) if it cannot be started.
  explicit ChildProcess(const std::vector<std::string>& command, const StartFailure& failure = {},
                        std::chrono::milliseconds patience = kChildPatience);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Writes to its standard input. False if it no longer reads; SIGPIPE must be ignored (see core/interruption.h).
  /// Throws Error(failure.kind) if it hangs.
  bool write(const void* bytes, std::size_t count);

  /// Closes its input and waits for its end. Returns its exit code, or 128 plus the signal that ended it. Throws as
  /// write() does.
  int finish();

  /// What it has printed so far; of its messages the last 64 kB.
  std::string standardOutput() const;
  std::string standardError() const;

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  void closeInput();
  int waitForEnd();
  void noteWait(std::chrono::milliseconds time);

  std::string program_;
  ErrorKind failureKind_;
  std::chrono::milliseconds patience_, idle_{0};
  long ticksBefore_ = 0;  // of its processor time, when idle_ began
  File output_, error_;   // files rather than pipes: a program that prints much is never blocked
  int input_ = -1;
  pid_t process_ = -1;
  std::optional<Remains> remains_;  // its group
};

}  // namespace cradle
