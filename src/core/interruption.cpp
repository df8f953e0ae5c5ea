#include "core/interruption.h"

#include <csignal>

#include "core/error.h"

namespace cradle {
namespace {

// The only global: a signal handler has no other place to write to.
volatile std::sig_atomic_t notedSignal = 0;

void note(int signal) {
  notedSignal = signal;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void noteInterruptions() {
  std::signal(SIGINT, note);
  std::signal(SIGTERM, note);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

int interruptingSignal() {
  return notedSignal;
}

void throwIfInterrupted() {
  if (notedSignal != 0) throw Error(ErrorKind::interrupted, "", notedSignal == SIGINT ? "interrupted" : "terminated");
}

}  // namespace cradle
