#pragma once

#include <atomic>
#include <exception>
#include <functional>

namespace cradle {

/// From now on SIGINT, SIGTERM and SIGHUP (a terminal that is closed; ignored under nohup) are noted instead of ending
/// the program at once, so that files are left in order; the same signal again, save SIGHUP, ends it at once. Work that
/// does not look within 3 s is ended with 128 and the number of the signal, and what would remain (core/crash.h) goes.
/// SIGPIPE and SIGXFSZ are ignored: a broken pipe, or a file beyond the shell's limit (ulimit -f), shows as a failed
/// write.
void noteInterruptions();

/// The signal that was noted (SIGINT, SIGTERM or SIGHUP), or 0.
int interruptingSignal();

/// Throws Error(ErrorKind::interrupted) if a signal was noted; from then on the end may take its time. Throws what the
/// watch of this thread does, if there is one.
void throwIfInterrupted();

/// For programs that have their own way to be interrupted: while it lives, throwIfInterrupted() calls look() in the
/// thread that made it. What that throws ends the work of the threads that help it as well (WorkerThreads).
class InterruptionWatch {
 public:
  explicit InterruptionWatch(std::function<void()> look);
  ~InterruptionWatch();
  InterruptionWatch(const InterruptionWatch&) = delete;
  InterruptionWatch& operator=(const InterruptionWatch&) = delete;

  /// The innermost of this thread, or null.
  static InterruptionWatch* ofThread();

  /// While it lives, this thread helps another one, whose watch (or null) is its own.
  class OfHelper {
   public:
    explicit OfHelper(InterruptionWatch* watch);
    ~OfHelper();
    OfHelper(const OfHelper&) = delete;
    OfHelper& operator=(const OfHelper&) = delete;
  };

 private:
  friend void throwIfInterrupted();
  void look();

  const std::function<void()> look_;
  InterruptionWatch* const outer_;
  std::atomic<bool> hasThrown_ = false;
  std::exception_ptr thrown_;  // set before hasThrown_
};

}  // namespace cradle
