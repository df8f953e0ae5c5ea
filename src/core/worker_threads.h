#pragma once

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "core/interruption.h"

namespace cradle {

/// Threads that do one task together and wait for each other inside it. The caller's is the first of them; the others
/// begin with the first task.
class WorkerThreads {
 public:
  /// `count` >= 1 threads, the caller's among them.
  explicit WorkerThreads(int count) : count_(count) {}
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  /// Fewer than asked after a task for which the system had no more.
  int count() const { return count_; }

  /// Calls task(thread) for thread = 0 .. count - 1, each on a thread of its own, and returns when all have returned.
  /// Throws the first of what the tasks throw; the others end at their next meeting then.
  void run(const std::function<void(int)>& task);

  /// Calls work(thread, first, last) for parts [first, last) of `size` things, `grain` in each, until all are done: a
  /// thread that is done early takes more of them. Throws as run() does.
  template <class Work>
  void share(std::size_t size, std::size_t grain, const Work& work) {
    if (count_ == 1) return work(0, std::size_t{0}, size);
    next_.store(0, std::memory_order_relaxed);
    run([&](int thread) {
      for (std::size_t first; (first = next_.fetch_add(grain, std::memory_order_relaxed)) < size;)
        work(thread, first, std::min(first + grain, size));
    });
  }

  /// To be called by all threads inside a task: none goes on before all have come.
  void meet();

  /// The part of `size` things that falls to a thread: [first, last).
  struct Part {
    std::size_t first, last;
  };
  Part partOf(std::size_t size, int thread) const;

 private:
  struct Broken {};  // another thread's task has thrown
  void start();
  void work(int thread);
  void doTask(int thread);
  void breakMeetings();
  void awaitHelpers();

  int count_;
  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable wake_;
  const std::function<void(int)>* task_ = nullptr;
  InterruptionWatch* watch_ = nullptr;  // of the thread that gave the task
  std::atomic<long> started_ = 0;       // tasks so far
  std::atomic<std::size_t> next_ = 0;   // of the things shared that nobody has taken
  std::atomic<bool> isClosing_ = false;
  std::atomic<int> waiting_ = 0;
  std::atomic<long> meetings_ = 0;
  std::atomic<bool> isBroken_ = false;     // the meetings of this task
  std::exception_ptr failure_;             // of the task that has thrown first; guarded by mutex_
  std::atomic<int> ended_ = 0;             // helpers that are done with the task
  std::atomic<double> helperSeconds_ = 0;  // CPU time of the task by all but the caller
};

/// Threads that this machine can run at once, at least 1.
int hardwareThreads();

}  // namespace cradle
