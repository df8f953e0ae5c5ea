#include "core/interruption.h"

#include <unistd.h>

#include <csignal>
#include <string_view>
#include <utility>

#include "core/crash.h"
#include "core/error.h"

namespace cradle {
namespace {

constexpr unsigned kPatience = 3;   // s from a signal to the next look at it: most looks are far less apart
constexpr int kExitOfSignal = 128;  // and its number, as shells have it

// The only global: a signal handler has no other place to write to.
volatile std::sig_atomic_t notedSignal = 0;

struct WatchOfThread {
  InterruptionWatch* watch = nullptr;
  bool isHelper = false;
};
thread_local WatchOfThread watchOfThread;

const char* wordOfNotedSignal() {
  if (notedSignal == SIGHUP) return "hung up";
  return notedSignal == SIGINT ? "interrupted" : "terminated";
}

/// For work that does not look whether a signal was noted.
void endUnnoticed(int /*signal*/) {
  removeRemains();
  for (const std::string_view text : {std::string_view(wordOfNotedSignal()), std::string_view("\n")})
    [[maybe_unused]] const ssize_t told = write(STDERR_FILENO, text.data(), text.size());
  _exit(kExitOfSignal + notedSignal);
}

void note(int signal) {
  std::signal(signal, signal == SIGHUP ? SIG_IGN : SIG_DFL);  // a terminal's end is told by the kernel and by the shell
  std::signal(SIGALRM, endUnnoticed);
  alarm(kPatience);
  notedSignal = signal;  // last: another thread may notice it at once, and ends the alarm
}

}  // namespace

void noteInterruptions() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  if (std::signal(SIGHUP, note) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // as under nohup
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int interruptingSignal() {
  return notedSignal;
}

void throwIfInterrupted() {
  if (watchOfThread.watch != nullptr) watchOfThread.watch->look();
  if (notedSignal == 0) return;
  alarm(0);  // noticed: to put files in order may take its time
  throw Error(ErrorKind::interrupted, "", wordOfNotedSignal());
}

InterruptionWatch::InterruptionWatch(std::function<void()> look) : look_(std::move(look)), outer_(watchOfThread.watch) {
  watchOfThread.watch = this;
}

InterruptionWatch::~InterruptionWatch() {
  watchOfThread.watch = outer_;
}

InterruptionWatch* InterruptionWatch::ofThread() {
  return watchOfThread.watch;
}

void InterruptionWatch::look() {
  if (hasThrown_) std::rethrow_exception(thrown_);
  if (watchOfThread.isHelper) return;
  try {
    look_();
  } catch (...) {
    thrown_ = std::current_exception();
    hasThrown_ = true;
    throw;
  }
}

InterruptionWatch::OfHelper::OfHelper(InterruptionWatch* watch) {
  watchOfThread = {watch, true};
}

InterruptionWatch::OfHelper::~OfHelper() {
  watchOfThread = {};
}

}  // namespace cradle
