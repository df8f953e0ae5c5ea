#pragma once

#include <sys/types.h>

#include <new>

namespace cradle {

/// What a crash would leave behind, while the object lives: a file, or a group of processes. The first eight of a
/// process are kept in mind.
class Remains {
 public:
  /// The path must stay where it is.
  explicit Remains(const char* path);
  explicit Remains(pid_t group);
  ~Remains();
  Remains(const Remains&) = delete;
  Remains& operator=(const Remains&) = delete;

 private:
  int place_;
};

/// Ends the processes and removes the files: for ends that run no destructors.
void removeRemains() noexcept;

/// From now on a crash (of Mesa without memory, say) does that too, and says so, before it ends the program.
void noteCrashes();

/// While it lives, memory that runs out ends the program at once, with the exit code of ErrorKind::limit and nothing
/// left behind: for code that cannot be unwound without memory.
class EndWithoutMemory {
 public:
  EndWithoutMemory();
  ~EndWithoutMemory();
  EndWithoutMemory(const EndWithoutMemory&) = delete;
  EndWithoutMemory& operator=(const EndWithoutMemory&) = delete;

 private:
  std::new_handler before_;
};

/// In a child process: what remains of the other is not its own and is forgotten, and a crash is the other's to tell.
/// Signals that end programs are the other's to note, too: the child ends with it.
void ignoreCrashes();

}  // namespace cradle
