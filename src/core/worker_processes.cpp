// Processes rather than threads: OpenGL's contexts on the CPU, the memory of a run and a crash stay apart. The next
// number lies in memory that all share; processes tell how far they are, and how they failed, through one pipe, in
// messages that are short enough to be written whole (pipe(7), PIPE_BUF).

#include "core/worker_processes.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "core/console.h"
#include "core/error.h"
#include "core/interruption.h"

namespace cradle {
namespace {

constexpr int kLookInterval = 100;  // ms: between looks at signals and at processes that ended

/// What a process says: a part of its work is done, or its error.
struct Message {
  static constexpr std::size_t kMaxText = 3000;
  int errorKind = 0;  // 0: done
  std::array<char, kMaxText> text{};
};
static_assert(sizeof(Message) <= PIPE_BUF);

/// The next number, in memory that processes share.
class SharedCounter {
 public:
  SharedCounter()
      : memory_(mmap(nullptr, sizeof(std::atomic<long>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::bad_alloc();
    next_ = new (memory_) std::atomic<long>(0);
  }
  ~SharedCounter() { munmap(memory_, sizeof(std::atomic<long>)); }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;

  long take() { return next_->fetch_add(1); }

 private:
  void* memory_;
  std::atomic<long>* next_;
};

void tell(int pipe, int errorKind, const std::string& text) {
  Message message;
  message.errorKind = errorKind;
  text.copy(message.text.data(), message.text.size() - 1);
  while (write(pipe, &message, sizeof message) < 0 && errno == EINTR) {
  }
}

using Work = std::function<void(long number, const std::function<void()>& tell)>;

[[noreturn]] void workInChild(SharedCounter& counter, long count, const Work& work, int pipe) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  int code = 0;
  try {
    for (long number; (number = counter.take()) < count;) {
      throwIfInterrupted();
      work(number, [pipe] { tell(pipe, 0, ""); });
    }
  } catch (const Error& error) {
    code = static_cast<int>(error.kind());
    tell(pipe, code, error.what());
  } catch (const std::bad_alloc&) {
    code = static_cast<int>(ErrorKind::limit);
    tell(pipe, code, "out of memory; make the scene or the picture smaller, or run fewer processes with -j");
  } catch (const std::exception& error) {
    code = 1;
    show(stderr, "cradle: {}. This is a bug in cradle.\n", error.what());
  }
  _exit(code);
}

/// The processes that work; those that are left are ended with the object.
class Workers {
 public:
  Workers(int processes, const std::function<void()>& runChild) {
    for (int i = 0; i < processes; ++i) {
      const pid_t process = fork();
      if (process == 0) runChild();
      if (process < 0) throw Error(ErrorKind::limit, "-j", "no more processes can be started; ask for fewer");
      running_.push_back(process);
    }
  }
  ~Workers() { end(SIGKILL), collect(true); }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  void end(int signal) const {
    for (const pid_t process : running_) kill(process, signal);
  }

  /// Takes leave of processes that have ended; true if one of them crashed.
  bool collect(bool waits) {
    bool hasCrashed = false;
    std::erase_if(running_, [&](pid_t process) {
      int status = 0;
      pid_t ended = 0;
      while ((ended = waitpid(process, &status, waits ? 0 : WNOHANG)) < 0 && errno == EINTR) {
      }
      hasCrashed = hasCrashed || (ended == process && (WIFSIGNALED(status) || WEXITSTATUS(status) == 1));
      return ended != 0;
    });
    return hasCrashed;
  }

  bool areRunning() const { return !running_.empty(); }

 private:
  std::vector<pid_t> running_;
};

/// The next message; none within a moment.
std::optional<Message> nextMessage(int pipe) {
  pollfd readable{pipe, POLLIN, 0};
  if (poll(&readable, 1, kLookInterval) <= 0 || (readable.revents & POLLIN) == 0) return std::nullopt;
  Message message;
  if (read(pipe, &message, sizeof message) != sizeof message) return std::nullopt;
  return message;
}

void watch(Workers& workers, int pipe, const std::function<void(long)>& done) {
  long finished = 0;
  std::optional<Message> fault;
  bool hasCrashed = false, isEnding = false;
  while (true) {
    const bool wereRunning = workers.areRunning();
    const auto message = nextMessage(pipe);
    if (message && message->errorKind == 0) done(++finished);
    if (message && message->errorKind != 0 && !fault) fault = message;
    if (!message && !wereRunning) break;  // what they said before they ended has been read
    hasCrashed = workers.collect(false) || hasCrashed;
    if ((fault || hasCrashed || interruptingSignal() != 0) && !isEnding) {
      workers.end(interruptingSignal() != 0 ? interruptingSignal() : SIGTERM);
      isEnding = true;
    }
  }
  throwIfInterrupted();
  if (fault) throw Error(static_cast<ErrorKind>(fault->errorKind), "", fault->text.data());
  if (hasCrashed)
    throw Error(ErrorKind::limit, "", "a process of -j ended before its work, perhaps for lack of memory");
}

}  // namespace

void shareAmongProcesses(int processes, long count, const Work& work, const std::function<void(long)>& done) {
  if (processes == 1 || count <= 1) {
    long parts = 0;
    for (long number = 0; number < count; ++number) {
      throwIfInterrupted();
      work(number, [&] { done(++parts); });
    }
    return;
  }
  SharedCounter counter;
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) throw Error(ErrorKind::limit, "", "no pipe can be opened");
  {
    Workers workers(processes, [&] { workInChild(counter, count, work, pipe[1]); });
    close(pipe[1]);
    watch(workers, pipe[0], done);
  }
  close(pipe[0]);
}

}  // namespace cradle
