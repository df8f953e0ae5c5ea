#include "core/crash.h"

#include <sys/prctl.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <string_view>

#include "core/error.h"

namespace cradle {
namespace {

/// A handler of signals may look at nothing that takes a lock.
struct Place {
  std::atomic<bool> isTaken{false};
  std::atomic<const char*> path{nullptr};
  std::atomic<pid_t> group{0};
};

std::array<Place, 8> places;
constexpr std::array kCrashes{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

int takePlace() {
  for (std::size_t place = 0; place < places.size(); ++place)
    if (!places[place].isTaken.exchange(true)) return static_cast<int>(place);
  return -1;
}

void tell(std::string_view words) {
  [[maybe_unused]] const ssize_t told = write(STDERR_FILENO, words.data(), words.size());
}

void endWithoutMemory() {
  removeRemains();
  tell("out of memory; make the scene or the picture smaller\n");
  std::_Exit(static_cast<int>(ErrorKind::limit));
}

void endCrashed(int signal) {
  constexpr std::string_view kWords =
      "cradle: crashed, perhaps for lack of memory; make the scene or the picture smaller. If that does not help, this "
      "is "
      "a bug in cradle.\n";
  removeRemains();
  tell(kWords);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

}  // namespace

Remains::Remains(const char* path) : place_(takePlace()) {
  if (place_ >= 0) places[static_cast<std::size_t>(place_)].path = path;
}

Remains::Remains(pid_t group) : place_(takePlace()) {
  if (place_ >= 0) places[static_cast<std::size_t>(place_)].group = group;
}

Remains::~Remains() {
  if (place_ < 0) return;
  Place& place = places[static_cast<std::size_t>(place_)];
  place.path = nullptr;
  place.group = 0;
  place.isTaken = false;
}

EndWithoutMemory::EndWithoutMemory() : before_(std::set_new_handler(endWithoutMemory)) {}

EndWithoutMemory::~EndWithoutMemory() {
  std::set_new_handler(before_);
}

void removeRemains() noexcept {
  for (const Place& place : places)  // first the processes: they write the files
    if (const pid_t group = place.group; group > 0) kill(-group, SIGKILL);
  for (const Place& place : places)
    if (const char* path = place.path) unlink(path);
}

void noteCrashes() {
  for (const int signal : kCrashes) std::signal(signal, endCrashed);
}

void ignoreCrashes() {
  for (const int signal : kCrashes) std::signal(signal, SIG_DFL);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (Place& place : places) {
    place.path = nullptr;
    place.group = 0;
  }
}

}  // namespace cradle
