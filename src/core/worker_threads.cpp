#include "core/worker_threads.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "core/cpu_stopwatch.h"

namespace cradle {
namespace {

constexpr int kSpins = 2000;  // looks before a thread goes to sleep: up to 0.1 ms, by the length of a pause

void pause() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

}  // namespace

int hardwareThreads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void WorkerThreads::start() {
  const int wanted = count_;
  threads_.reserve(static_cast<std::size_t>(wanted));
  try {
    for (int thread = 1; thread < wanted; ++thread) threads_.emplace_back([this, thread] { work(thread); });
  } catch (const std::system_error&) {  // the work is the same for fewer
    count_ = 1 + static_cast<int>(threads_.size());
  }
}

WorkerThreads::~WorkerThreads() {
  {
    const std::lock_guard lock(mutex_);
    isClosing_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerThreads::run(const std::function<void(int)>& task) {
  if (count_ > 1 && threads_.empty()) start();
  if (count_ == 1) return task(0);
  {
    const std::lock_guard lock(mutex_);
    task_ = &task;
    watch_ = InterruptionWatch::ofThread();
    started_.fetch_add(1, std::memory_order_release);
  }
  wake_.notify_all();
  doTask(0);
  awaitHelpers();
  addCpuSecondsOfHelpers(helperSeconds_.exchange(0));
  if (!isBroken_) return;
  isBroken_ = false;
  waiting_ = 0;
  std::rethrow_exception(std::exchange(failure_, nullptr));
}

/// What it throws is kept, and no thread waits for this one any more.
void WorkerThreads::doTask(int thread) {
  try {
    (*task_)(thread);
  } catch (const Broken&) {
  } catch (...) {
    {
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
    breakMeetings();
  }
}

/// Who comes to a meeting later sees isBroken_; who waits in one wakes.
void WorkerThreads::breakMeetings() {
  isBroken_ = true;
  meetings_.fetch_add(1);
  meetings_.notify_all();
}

void WorkerThreads::awaitHelpers() {
  for (int spins = 0; spins < kSpins && ended_.load(std::memory_order_acquire) < count_ - 1; ++spins) pause();
  for (int ended; (ended = ended_.load(std::memory_order_acquire)) < count_ - 1;) ended_.wait(ended);
  ended_.store(0, std::memory_order_relaxed);
}

void WorkerThreads::work(int thread) {
  for (long done = 0;; ++done) {
    // The next task mostly comes before this thread could be put to sleep and woken.
    for (int spins = 0; spins < kSpins && started_.load(std::memory_order_acquire) == done && !isClosing_; ++spins)
      pause();
    if (started_.load(std::memory_order_acquire) == done) {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return isClosing_ || started_.load() > done; });
      if (isClosing_) return;
    }
    const double before = cpuSecondsOfThread();
    {
      const InterruptionWatch::OfHelper watched(watch_);
      doTask(thread);
    }
    helperSeconds_.fetch_add(cpuSecondsOfThread() - before);
    ended_.fetch_add(1, std::memory_order_acq_rel);
    ended_.notify_all();
  }
}

void WorkerThreads::meet() {
  if (count_ == 1) return;
  const long meeting = meetings_.load();
  if (isBroken_) throw Broken();
  if (waiting_.fetch_add(1, std::memory_order_acq_rel) + 1 == count_) {
    waiting_.store(0, std::memory_order_relaxed);
    meetings_.fetch_add(1, std::memory_order_acq_rel);
    meetings_.notify_all();
    return;
  }
  for (int spins = 0; spins < kSpins && meetings_.load(std::memory_order_acquire) == meeting; ++spins) pause();
  meetings_.wait(meeting, std::memory_order_acquire);
  if (isBroken_) throw Broken();
}

WorkerThreads::Part WorkerThreads::partOf(std::size_t size, int thread) const {
  const std::size_t threads = static_cast<std::size_t>(count_), index = static_cast<std::size_t>(thread);
  return {size * index / threads, size * (index + 1) / threads};
}

}  // namespace cradle
