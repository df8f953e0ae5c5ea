#include "mesh/confined_child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <seccomp.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <new>

#include "core/crash.h"
#include "core/error.h"
#include "core/interruption.h"

namespace cradle {
namespace {

constexpr int kAnswerFile = 3;      // of the child: the first after the three that all have
constexpr rlim_t kMaxFiles = 64;    // open at once
constexpr int kLookInterval = 100;  // ms between two looks for a signal, of whoever waits for the answer
// The first byte of what the child sends: the answer, an Error (its kind follows), or why there is none.
constexpr char kAnswer = 'A', kError = 'E', kFailure = 'F';

std::uint64_t startMemory = 0;  // bytes, of the child; 0: this process is none

void limit(__rlimit_resource resource, rlim_t soft, rlim_t hard) {
  const rlimit limits{soft, hard};
  setrlimit(resource, &limits);  // fails only where a lower limit holds already
}

std::uint64_t addressSpaceInUse() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;  // first number: program size
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Of the system's calls those that reading files, computing and answering need; the others fail. Where the system has
/// no such filters, limits have to do.
void filterSystemCalls() {
  const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
  if (filter == nullptr) return;
  for (const int call :
       {SCMP_SYS(read),        SCMP_SYS(pread64),       SCMP_SYS(readv),          SCMP_SYS(write),
        SCMP_SYS(writev),      SCMP_SYS(close),         SCMP_SYS(lseek),          SCMP_SYS(fstat),
        SCMP_SYS(stat),        SCMP_SYS(lstat),         SCMP_SYS(newfstatat),     SCMP_SYS(statx),
        SCMP_SYS(access),      SCMP_SYS(faccessat),     SCMP_SYS(faccessat2),     SCMP_SYS(readlink),
        SCMP_SYS(readlinkat),  SCMP_SYS(getcwd),        SCMP_SYS(mmap),           SCMP_SYS(munmap),
        SCMP_SYS(mremap),      SCMP_SYS(mprotect),      SCMP_SYS(madvise),        SCMP_SYS(brk),
        SCMP_SYS(futex),       SCMP_SYS(sched_yield),   SCMP_SYS(getpid),         SCMP_SYS(gettid),
        SCMP_SYS(getrandom),   SCMP_SYS(clock_gettime), SCMP_SYS(gettimeofday),   SCMP_SYS(getrlimit),
        SCMP_SYS(setrlimit),   SCMP_SYS(rt_sigaction),  SCMP_SYS(rt_sigprocmask), SCMP_SYS(rt_sigreturn),
        SCMP_SYS(sigaltstack), SCMP_SYS(tgkill),        SCMP_SYS(exit),           SCMP_SYS(exit_group)})
    seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0);
  const auto allowWhere = [&](int call, const scmp_arg_cmp& condition) {
    seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, call, 1, &condition);
  };
  allowWhere(SCMP_SYS(prlimit64), {0, SCMP_CMP_EQ, 0, 0});  // limits of its own
  constexpr scmp_datum_t kWriting = O_ACCMODE | O_CREAT | O_TRUNC;
  allowWhere(SCMP_SYS(open), {1, SCMP_CMP_MASKED_EQ, kWriting, O_RDONLY});
  allowWhere(SCMP_SYS(openat), {2, SCMP_CMP_MASKED_EQ, kWriting, O_RDONLY});
  seccomp_load(filter);
  seccomp_release(filter);
}

/// What the work needs of the system, and nothing else.
void confine(const ChildLimits& limits, int answer) {
  startMemory = addressSpaceInUse();
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int file : {STDIN_FILENO, STDOUT_FILENO}) dup2(nowhere, file);
  dup2(nowhere, STDERR_FILENO);  // a failed assertion speaks there, in words that mean nothing to the user
  if (answer != kAnswerFile) dup2(answer, kAnswerFile);
  close_range(kAnswerFile + 1, ~0U, 0);
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_FSIZE, 0, 0);
  limit(RLIMIT_NPROC, 0, 0);
  limit(RLIMIT_NOFILE, kMaxFiles, kMaxFiles);
  limit(RLIMIT_CPU, limits.cpuSeconds, limits.cpuSeconds);
  limit(RLIMIT_AS, startMemory + limits.memory, startMemory + limits.mostMemory);
  filterSystemCalls();
}

bool send(const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t length = write(kAnswerFile, bytes.data() + sent, bytes.size() - sent);
    if (length < 0 && errno != EINTR) return false;
    if (length > 0) sent += static_cast<std::size_t>(length);
  }
  return true;
}

[[noreturn]] void runChild(const std::function<std::string()>& work, const ChildLimits& limits, int answer) {
  ignoreCrashes();
  confine(limits, answer);
  bool isSent = false;
  try {
    const std::string bytes = work();
    isSent = send(std::string(1, kAnswer)) && send(bytes);
  } catch (const Error& error) {
    isSent = send({kError, static_cast<char>(error.kind())}) && send(error.what());
  } catch (const std::bad_alloc&) {
    isSent = send(kFailure + std::string("needs more memory than such a file should"));
  } catch (const std::exception& error) {
    isSent = send(kFailure + std::string(error.what()));
  }
  _exit(isSent ? 0 : 1);
}

/// All that comes, or, once a signal is noted, what has come until then.
std::string receive(int file) {
  std::string bytes;
  std::array<char, 1 << 16> buffer{};
  for (ssize_t length = 1; length != 0;) {
    pollfd readable{file, POLLIN, 0};
    const int found = poll(&readable, 1, kLookInterval);  // unlike read, it ends when a signal comes
    if (interruptingSignal() != 0) break;
    if (found <= 0) continue;
    length = read(file, buffer.data(), buffer.size());
    if (length > 0) bytes.append(buffer.data(), static_cast<std::size_t>(length));
    if (length < 0 && errno != EINTR) break;
  }
  return bytes;
}

}  // namespace

ChildAnswer answerOfChild(const std::function<std::string()>& work, const ChildLimits& limits) {
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) throw Error(ErrorKind::limit, "", "no pipe can be opened");
  const pid_t child = fork();
  if (child < 0) throw Error(ErrorKind::limit, "", "no process can be started");
  if (child == 0) runChild(work, limits, pipe[1]);

  close(pipe[1]);
  std::string sent = receive(pipe[0]);
  close(pipe[0]);
  if (interruptingSignal() != 0) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  throwIfInterrupted();
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
    return {{}, fmt::format("takes longer than {} s", limits.cpuSeconds)};
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || sent.empty()) return {{}, "makes the importer crash"};
  if (sent[0] == kError && sent.size() > 1) throw Error(static_cast<ErrorKind>(sent[1]), "", sent.substr(2));
  if (sent[0] != kAnswer) return {{}, sent.substr(1)};
  sent.erase(0, 1);
  return {std::move(sent), {}};
}

void limitMemory(std::uint64_t bytes) {
  if (startMemory == 0) return;
  rlimit limits{};
  getrlimit(RLIMIT_AS, &limits);
  limits.rlim_cur = std::min<rlim_t>(startMemory + bytes, limits.rlim_max);
  setrlimit(RLIMIT_AS, &limits);
}

}  // namespace cradle
