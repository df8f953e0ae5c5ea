#pragma once

namespace cradle {

/// s: the CPU time of this thread, and of what other threads have done for it (addCpuSecondsOfHelpers).
double cpuSecondsOfThread();

/// Counts CPU time (s) that other threads have spent on a task of this one.
void addCpuSecondsOfHelpers(double seconds);

/// Adds up the CPU time of this thread and its helpers between start() and stop(), without what reading the clock costs
/// by itself: a system call, which would be a fifth of the cheapest simulations.
class CpuStopwatch {
 public:
  CpuStopwatch();

  void start();
  void stop();

  /// s, >= 0.
  double seconds() const { return seconds_; }

 private:
  double ownCost_ = 0;  // s, of a start and a stop with nothing between
  double start_ = 0, seconds_ = 0;
};

}  // namespace cradle
