#include "mesh/trial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>

#include "core/error.h"

namespace cradle {
namespace {

void limit(__rlimit_resource resource, std::uint64_t value) {
  const rlimit limits{value, value};
  setrlimit(resource, &limits);  // fails only where a lower limit holds already
}

std::uint64_t addressSpaceInUse() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;  // first number: program size
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

[[noreturn]] void runChild(const std::function<std::string()>& work, const TrialLimits& limits, int answer) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.cpuSeconds);
  limit(RLIMIT_AS, addressSpaceInUse() + limits.memory);
  const int nowhere = open("/dev/null", O_WRONLY);
  dup2(nowhere, STDERR_FILENO);  // a failed assertion speaks there, in words that mean nothing to the user
  std::string message;
  try {
    message = work();
  } catch (const std::exception& error) {
    message = error.what();
  }
  const ssize_t written = write(answer, message.data(), message.size());
  _exit(written == static_cast<ssize_t>(message.size()) ? 0 : 1);
}

std::string readAll(int file) {
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t length = 1; length != 0;) {
    length = read(file, buffer.data(), buffer.size());
    if (length > 0) text.append(buffer.data(), static_cast<std::size_t>(length));
    if (length < 0 && errno != EINTR) break;
  }
  return text;
}

}  // namespace

std::string tryInChild(const std::function<std::string()>& work, const TrialLimits& limits) {
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) throw Error(ErrorKind::limit, "", "no pipe can be opened");
  const pid_t child = fork();
  if (child < 0) throw Error(ErrorKind::limit, "", "no process can be started");
  if (child == 0) runChild(work, limits, pipe[1]);

  close(pipe[1]);
  const std::string message = readAll(pipe[0]);
  close(pipe[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return message;
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
    return fmt::format("takes longer than {} s", limits.cpuSeconds);
  return "makes the importer crash";
}

}  // namespace cradle
