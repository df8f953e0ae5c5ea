#include "image/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "core/interruption.h"

extern char** environ;

namespace cradle {
namespace {

constexpr std::chrono::milliseconds kTurn{100};  // of waiting, until signals are looked at
constexpr off_t kLastWords = 1 << 16;            // bytes of messages that are kept
constexpr int kPipeBytes = 1 << 20;  // the most that Linux gives everyone: fewer turns between the two programs

[[noreturn]] void failStart(const std::string& program, const StartFailure& failure, int error) {
  const std::string remedy =
      error == ENOENT ? fmt::format("; install the package {}, or put it into PATH", failure.package) : "";
  throw Error(failure.kind, program, std::string("cannot be started: ") + std::strerror(error) + remedy);
}

std::FILE* openTemporary(const std::string& program, const StartFailure& failure) {
  std::FILE* file = std::tmpfile();
  if (file == nullptr) failStart(program, failure, errno);
  fcntl(fileno(file), F_SETFD, FD_CLOEXEC);
  return file;
}

/// From `offset` (bytes) on.
std::string readFrom(std::FILE* file, off_t offset) {
  std::string text;
  std::array<char, 4096> part;
  while (true) {
    const ssize_t count = pread(fileno(file), part.data(), part.size(), offset);
    if (count <= 0) return text;
    text.append(part.data(), static_cast<std::size_t>(count));
    offset += count;
  }
}

/// The start of a process with its three standard files, its own group and the default reaction to SIGPIPE.
class SpawnRequest {
 public:
  SpawnRequest(int input, int output, int error) {
    posix_spawn_file_actions_init(&files_);
    posix_spawn_file_actions_adddup2(&files_, input, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files_, output, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&files_, error, STDERR_FILENO);
    sigset_t pipeSignal;
    sigemptyset(&pipeSignal);
    sigaddset(&pipeSignal, SIGPIPE);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setsigdefault(&attributes_, &pipeSignal);
    posix_spawnattr_setpgroup(&attributes_, 0);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnRequest() {
    posix_spawn_file_actions_destroy(&files_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnRequest(const SpawnRequest&) = delete;
  SpawnRequest& operator=(const SpawnRequest&) = delete;

  /// 0, or what went wrong.
  int start(std::vector<std::string> command, pid_t& process) {
    std::vector<char*> arguments;
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    return posix_spawnp(&process, arguments[0], &files_, &attributes_, arguments.data(), environ);
  }

 private:
  posix_spawn_file_actions_t files_;
  posix_spawnattr_t attributes_;
};

/// Processor time of all processes of a group, and of those that they have waited for, in clock ticks. (proc(5),
/// /proc/PID/stat)
long ticksOfGroup(pid_t group) {
  long sum = 0;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", failed)) {
    std::ifstream file(entry.path() / "stat");
    std::string text, skipped;
    std::getline(file, text);
    const std::size_t name = text.rfind(") ");  // it may hold spaces and brackets
    if (name == std::string::npos) continue;
    std::istringstream fields(text.substr(name + 2));
    long ofGroup = 0, ticks = 0;
    fields >> skipped >> skipped >> ofGroup;
    for (int field = 6; field < 14; ++field) fields >> skipped;
    for (int field = 14; field < 18 && fields >> ticks; ++field) sum += ofGroup == group ? ticks : 0;
  }
  return sum;
}

/// Whether that much processor time (clock ticks) is less than a hundredth of `time`.
bool isIdle(long ticks, std::chrono::milliseconds time) {
  return 1e5 * static_cast<double>(ticks) < static_cast<double>(sysconf(_SC_CLK_TCK) * time.count());
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& command, const StartFailure& failure,
                           std::chrono::milliseconds patience)
    : program_(command.at(0)),
      failureKind_(failure.kind),
      patience_(patience),
      output_(openTemporary(command.at(0), failure), std::fclose),
      error_(openTemporary(command.at(0), failure), std::fclose) {
  std::array<int, 2> ends;
  if (pipe2(ends.data(), O_CLOEXEC) != 0) failStart(command[0], failure, errno);
  fcntl(ends[1], F_SETPIPE_SZ, kPipeBytes);
  fcntl(ends[1], F_SETFL, O_NONBLOCK);
  SpawnRequest request(ends[0], fileno(output_.get()), fileno(error_.get()));
  const int error = request.start(command, process_);
  close(ends[0]);
  input_ = ends[1];
  if (error != 0) {
    closeInput();
    failStart(command[0], failure, error);
  }
  remains_.emplace(process_);
}

ChildProcess::~ChildProcess() {
  closeInput();
  if (process_ < 0) return;
  kill(-process_, SIGKILL);
  waitpid(process_, nullptr, 0);
}

bool ChildProcess::write(const void* bytes, std::size_t count) {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::write(input_, next, count);
    if (written < 0 && errno == EAGAIN) {
      pollfd room{input_, POLLOUT, 0};
      if (poll(&room, 1, static_cast<int>(kTurn.count())) == 0) noteWait(kTurn);
      continue;
    }
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EPIPE) return false;
    if (written < 0) throw Error(failureKind_, program_, fmt::format("cannot be written to: {}", std::strerror(errno)));
    idle_ = {};
    next += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

int ChildProcess::finish() {
  closeInput();
  return waitForEnd();
}

std::string ChildProcess::standardOutput() const {
  return readFrom(output_.get(), 0);
}

std::string ChildProcess::standardError() const {
  const off_t size = lseek(fileno(error_.get()), 0, SEEK_END);
  return readFrom(error_.get(), std::max<off_t>(0, size - kLastWords));
}

void ChildProcess::closeInput() {
  if (input_ >= 0) close(input_);
  input_ = -1;
}

int ChildProcess::waitForEnd() {
  std::chrono::milliseconds turn{1};
  idle_ = {};
  for (int status = 0;;) {
    const pid_t ended = waitpid(process_, &status, WNOHANG);
    if (ended == 0) {
      std::this_thread::sleep_for(turn);
      noteWait(turn);
      turn = std::min(2 * turn, kTurn);
    } else if (ended == process_) {
      process_ = -1;
      remains_.reset();
      return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    } else if (errno != EINTR) {
      return 127;  // nobody there to wait for
    }
  }
}

/// `time` has passed without an answer.
void ChildProcess::noteWait(std::chrono::milliseconds time) {
  throwIfInterrupted();
  if (idle_.count() == 0) ticksBefore_ = ticksOfGroup(process_);
  idle_ += time;
  if (idle_ < patience_) return;
  if (isIdle(ticksOfGroup(process_) - ticksBefore_, idle_))
    throw Error(failureKind_, program_,
                fmt::format("hangs: it has done nothing for {} s, and was ended; run it by itself to see why",
                            std::chrono::duration<double>(idle_).count()));
  idle_ = {};
}

}  // namespace cradle
