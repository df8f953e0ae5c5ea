#pragma once

#include <exception>
#include <stdexcept>
#include <string>

namespace cradle {

/// What went wrong, and with it the exit code of the program. 1 is left to our own bugs (CRADLE_CHECK).
enum class ErrorKind {
  usage = 2,         // command line
  scene = 3,         // scene text
  mesh = 4,          // a mesh file missing, unreadable or unusable
  output = 5,        // disk full, not writable, not ours to replace
  encoder = 6,       // ffmpeg missing or failed
  unstable = 7,      // non-finite state or unexplained energy
  limit = 8,         // memory, events per second
  different = 9,     // a comparison found a difference
  interrupted = 130  // SIGINT; SIGTERM is 143, see interruption.h
};

/// Something the user can mend: scene, mesh, command line, disk. Loaders and simulations throw it, only main catches
/// it.
class Error : public std::exception {
 public:
  /// `where` is a place the user can go to ("scenes/pendulum.json:12:7 /bodies/0/mass", a file, an option);
  /// `what` says what was found, what is allowed and what to do. Both are shown as printableLine() has it.
  Error(ErrorKind kind, const std::string& where, const std::string& what);
  /// Of several lines, shown as printable() has it: names in them are printable already.
  static Error ofLines(ErrorKind kind, const std::string& lines);
  const char* what() const noexcept override { return message_.c_str(); }
  ErrorKind kind() const { return kind_; }

 private:
  Error(ErrorKind kind, std::string message) : kind_(kind), message_(std::move(message)) {}

  ErrorKind kind_;
  std::string message_;  // "where: what"
};

/// A mistake of our own: CRADLE_CHECK throws it, and only main catches it.
class FailedCheck : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Throws FailedCheck with `condition` and its place.
[[noreturn]] void failCheck(const char* condition, const char* file, int line);

}  // namespace cradle

/// For mistakes of our own, not the user's: always on; throws FailedCheck.
#define CRADLE_CHECK(condition) \
  ((condition) ? static_cast<void>(0) : ::cradle::failCheck(#condition, __FILE__, __LINE__))
