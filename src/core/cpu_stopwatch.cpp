#include "core/cpu_stopwatch.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace cradle {
namespace {

constexpr int kTrials = 10;  // the least of them is not disturbed

/// CPU time of this thread in s.
double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

CpuStopwatch::CpuStopwatch() : ownCost_(INFINITY) {
  for (int trial = 0; trial < kTrials; ++trial) {
    const double before = threadSeconds();
    ownCost_ = std::min(ownCost_, threadSeconds() - before);
  }
}

void CpuStopwatch::start() {
  start_ = threadSeconds();
}

void CpuStopwatch::stop() {
  seconds_ += std::max(0.0, threadSeconds() - start_ - ownCost_);
}

}  // namespace cradle
