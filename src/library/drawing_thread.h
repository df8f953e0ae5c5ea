#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>

namespace cradle::v1 {

/// The thread in which all films of a process are made, drawn and taken apart: Mesa hangs where a context goes in
/// another thread than the one that drew with it.
class DrawingThread {
 public:
  /// It begins with the first call, and lasts as long as the process. Throws Error(limit) in a forked child of a
  /// process that has drawn: there Mesa waits for threads that are the parent's.
  static DrawingThread& ofProcess();

  /// Whether contexts are gone: in such a child, and when the process ends.
  static bool isLost();

  /// Returns, or throws, what work() does there.
  template <class Work>
  auto run(const Work& work) {
    const auto task = std::make_shared<std::packaged_task<decltype(work())()>>(std::ref(work));
    auto result = task->get_future();
    put([task] { (*task)(); });
    return result.get();
  }

 private:
  DrawingThread();
  void put(std::function<void()> task);
  [[noreturn]] void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
};

}  // namespace cradle::v1
