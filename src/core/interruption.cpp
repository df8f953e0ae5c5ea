#include "core/interruption.h"

#include <unistd.h>

#include <csignal>
#include <string_view>

#include "core/crash.h"
#include "core/error.h"

namespace cradle {
namespace {

constexpr unsigned kPatience = 3;   // s from a signal to the next look at it: most looks are far less apart
constexpr int kExitOfSignal = 128;  // and its number, as shells have it

// The only global: a signal handler has no other place to write to.
volatile std::sig_atomic_t notedSignal = 0;

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
  if (notedSignal == 0) return;
  alarm(0);  // noticed: to put files in order may take its time
  throw Error(ErrorKind::interrupted, "", wordOfNotedSignal());
}

}  // namespace cradle
