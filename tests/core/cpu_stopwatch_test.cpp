#include "core/cpu_stopwatch.h"

#include <gtest/gtest.h>

#include <ctime>

#include "core/worker_threads.h"

namespace cradle {
namespace {

/// Computes until this thread has used up so many seconds.
void work(double seconds) {
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  const double end = now() + seconds;
  while (now() < end) continue;
}

// A clock's own cost is some microseconds at most.
TEST(CpuStopwatch, AddsUpWhatIsBetweenStartAndStop) {
  CpuStopwatch stopwatch;
  for (int i = 0; i < 3; ++i) {
    stopwatch.start();
    work(0.002);
    stopwatch.stop();
    work(0.005);
  }
  EXPECT_GT(stopwatch.seconds(), 3 * 0.0019);
  EXPECT_LT(stopwatch.seconds(), 3 * 0.005);
}

// Two threads that work for 4 ms each are 8 ms, and so are those that work for one of them.
TEST(CpuStopwatch, AddsWhatOtherThreadsDoForThisOne) {
  WorkerThreads threads(2);
  CpuStopwatch stopwatch;
  stopwatch.start();
  threads.run([](int) { work(0.004); });
  stopwatch.stop();
  EXPECT_GT(stopwatch.seconds(), 0.00395 * threads.count());  // one, where the system has no second thread
}

TEST(CpuStopwatch, IsNeverNegative) {
  CpuStopwatch stopwatch;
  for (int i = 0; i < 1000; ++i) {
    const double before = stopwatch.seconds();
    stopwatch.start();
    stopwatch.stop();
    EXPECT_GE(stopwatch.seconds(), before);
  }
}

}  // namespace
}  // namespace cradle
