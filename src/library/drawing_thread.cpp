#include "library/drawing_thread.h"

#include <unistd.h>

#include <atomic>
#include <cfenv>
#include <cstdlib>
#include <thread>
#include <utility>

#include "core/error.h"
#include "render/offscreen_context.h"

namespace cradle::v1 {

namespace {

std::atomic<pid_t> owner = 0;        // the process that draws
std::atomic<bool> hasEnded = false;  // Mesa takes its own apart behind that

}  // namespace

DrawingThread& DrawingThread::ofProcess() {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (isLost())
    throw cradle::Error(
        cradle::ErrorKind::limit, "OpenGL",
        "a process has drawn before it forked this one, which therefore cannot draw; draw in one of them "
        "alone, or start the other as a program of its own (Python's multiprocessing: spawn)");
  static DrawingThread* const thread =
      new DrawingThread;  // never destroyed: films may go with a program's last objects
  if (owner == 0) {
    thread->run([] { OffscreenContext(); });  // opens Mesa, whose handlers of the end run behind those that come now
    std::atexit([] { hasEnded = true; });
    owner = getpid();
  }
  return *thread;
}

bool DrawingThread::isLost() {
  return hasEnded || (owner != 0 && owner != getpid());
}

DrawingThread::DrawingThread() {
  std::thread([this] { work(); }).detach();
}

void DrawingThread::put(std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  changed_.notify_one();
}

void DrawingThread::work() {
  std::fesetenv(FE_DFL_ENV);  // pictures do not depend on who began
  for (;;) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !tasks_.empty(); });
    const std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task();
  }
}

}  // namespace cradle::v1
