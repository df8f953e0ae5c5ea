#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <functional>

namespace cradle {

constexpr uid_t kNobody = 65534;  // to become where permissions matter: they do not stop the superuser

/// Runs `action` in a process of its own and returns how that ended; an exception shows as 99.
inline int statusOfProcess(const std::function<int()>& action) {
  const pid_t process = fork();
  if (process == 0) {
    try {
      _exit(action());
    } catch (...) {
      _exit(99);
    }
  }
  int status = 0;
  waitpid(process, &status, 0);
  return status;
}

}  // namespace cradle
