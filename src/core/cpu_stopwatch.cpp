#include "core/cpu_stopwatch.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace cradle {
namespace {

constexpr int kTrials = 10;  // the least of them is not disturbed

thread_local double secondsOfHelpers = 0;

}  // namespace

double cpuSecondsOfThread() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) + secondsOfHelpers;
}

void addCpuSecondsOfHelpers(double seconds) {
  secondsOfHelpers += seconds;
}

CpuStopwatch::CpuStopwatch() : ownCost_(INFINITY) {
  for (int trial = 0; trial < kTrials; ++trial) {
    const double before = cpuSecondsOfThread();
    ownCost_ = std::min(ownCost_, cpuSecondsOfThread() - before);
  }
}

void CpuStopwatch::start() {
  start_ = cpuSecondsOfThread();
}

void CpuStopwatch::stop() {
  seconds_ += std::max(0.0, cpuSecondsOfThread() - start_ - ownCost_);
}

}  // namespace cradle
