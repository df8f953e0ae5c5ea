#pragma once

#include <stdexcept>
#include <string>

namespace cradle::v1 {

/// What went wrong; the numbers are the exit codes of the program `cradle`.
enum class ErrorKind {
  usage = 2,     // an argument, or a file that is no trajectory
  scene = 3,     // the text of a scene
  mesh = 4,      // a mesh file missing, unreadable or unusable
  output = 5,    // disk full, not writable, not ours to replace
  unstable = 7,  // a state that is not finite, or energy out of nothing
  limit = 8      // memory, events per second, sizes of pictures
};

/// Something that the caller can mend. what() has the words of the program: where, what was found, what is allowed.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

/// A check inside Cradle that failed, which is a bug in Cradle. Objects that were in use are not to be used again.
class FailedCheck : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

}  // namespace cradle::v1
