#pragma once

#include <time.h>

#include <atomic>
#include <functional>
#include <utility>

namespace cradle {

/// Tells the simulated time (s) that a run has reached inside a frame which takes longer than a second, once a second:
/// such a run does not look like one that hangs.
class LifeSign {
 public:
  /// `tell` may be none.
  explicit LifeSign(std::function<void(double time)> tell) : tell_(std::move(tell)) { beginFrame(); }

  void beginFrame() {
    if (tell_) last_ = now();
  }

  /// To be called after each step, which may take less than a microsecond.
  void note(double time) {
    if (!tell_ || now() - last_ < kInterval) return;
    last_ = now();
    tell_(time);
  }

 private:
  static constexpr double kInterval = 1;  // s

  /// s; right to some milliseconds: the kernel's last tick takes a few nanoseconds to read, its clock far more.
  static double now() {
    timespec tick{};
    clock_gettime(CLOCK_MONOTONIC_COARSE, &tick);
    return static_cast<double>(tick.tv_sec) + 1e-9 * static_cast<double>(tick.tv_nsec);
  }

  std::function<void(double time)> tell_;
  double last_ = 0;  // s
};

/// The life signs of islands that several threads move: the first thread gives them, and what `tell` throws ends all.
class SharedLifeSign {
 public:
  /// Thrown in islands of other threads, and in later ones, once `tell` has thrown.
  struct Over {};

  /// `tell` may be none.
  explicit SharedLifeSign(const std::function<void(double time)>& tell) {
    if (!tell) return;
    other_ = [this](double) {
      if (isOver_) throw Over();
    };
    first_ = [this, &tell](double time) {
      other_(time);
      try {
        tell(time);
      } catch (...) {
        isOver_ = true;
        throw;
      }
    };
  }
  SharedLifeSign(const SharedLifeSign&) = delete;
  SharedLifeSign& operator=(const SharedLifeSign&) = delete;

  /// To be called by islands that this thread moves, after each step; may be none.
  const std::function<void(double time)>& ofThread(int thread) const { return thread == 0 ? first_ : other_; }

 private:
  std::atomic<bool> isOver_ = false;
  std::function<void(double)> first_, other_;
};

}  // namespace cradle
