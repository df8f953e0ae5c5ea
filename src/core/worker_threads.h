#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace cradle {

/// Threads that do one task together and wait for each other inside it. The caller's is the first of them.
class WorkerThreads {
 public:
  /// `count` >= 1 threads, the caller's among them.
  explicit WorkerThreads(int count);
  ~WorkerThreads();
  WorkerThreads(const WorkerThreads&) = delete;
  WorkerThreads& operator=(const WorkerThreads&) = delete;

  int count() const { return count_; }

  /// Calls task(thread) for thread = 0 .. count - 1, each on a thread of its own, and returns when all have returned.
  /// The task must not throw.
  void run(const std::function<void(int)>& task);

  /// To be called by all threads inside a task: none goes on before all have come.
  void meet();

  /// The part of `size` things that falls to a thread: [first, last).
  struct Part {
    std::size_t first, last;
  };
  Part partOf(std::size_t size, int thread) const;

 private:
  void work(int thread);

  const int count_;
  std::vector<std::thread> threads_;
  std::mutex mutex_;
  std::condition_variable wake_;
  const std::function<void(int)>* task_ = nullptr;
  std::atomic<long> started_ = 0;  // tasks so far
  bool isClosing_ = false;
  std::atomic<int> waiting_ = 0;
  std::atomic<long> meetings_ = 0;
};

/// Threads that this machine can run at once, at least 1.
int hardwareThreads();

}  // namespace cradle
