#pragma once

#include "core/worker_threads.h"
#include "simulate/thresholds.h"

namespace cradle {

/// Calls work(thread, island) for island = 0 ... islands - 1: on all threads if the islands took as many `evaluations`
/// of their equations the last time that it is worth it, else on this one, which is thread 0. The work must not throw.
template <class Work>
void shareIslands(WorkerThreads& threads, std::size_t islands, long evaluations, const Work& work) {
  const auto moveSome = [&](int thread, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) work(thread, i);
  };
  if (evaluations < kSharedEvaluations)
    moveSome(0, 0, islands);
  else
    threads.share(islands, 1, moveSome);
}

}  // namespace cradle
