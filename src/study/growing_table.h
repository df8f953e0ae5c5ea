#pragma once

#include <string>
#include <vector>

namespace cradle {

/// A table of comma-separated values that grows: FILE.part holds all lines so far at any moment, and becomes FILE when
/// complete. Without a line, which would be of no use to a later run, it goes.
class GrowingTable {
 public:
  /// Begins FILE.part with `columns`, or goes on after its first `keptBytes`, if that is not 0. Throws Error(output) if
  /// it cannot be written, or another run writes it.
  GrowingTable(const std::string& path, const std::string& columns, std::size_t keptBytes = 0);
  ~GrowingTable();
  GrowingTable(const GrowingTable&) = delete;
  GrowingTable& operator=(const GrowingTable&) = delete;

  /// `line` has its newline.
  void append(const std::string& line);
  /// Ends with the last of `lines`, which stand in for as many as were appended last.
  void replaceLast(const std::vector<std::string>& lines);
  void complete();
  /// Keeps FILE.part even without a line: a file beside it has some.
  void keep() { isKept_ = true; }

 private:
  [[noreturn]] void fail() const;
  std::string wholeText() const;
  void cutTo(std::size_t bytes);
  void write(const std::string& text);
  void end();

  std::string path_;
  int file_ = -1;        // descriptor; locked: no other of that file may be closed
  bool isKept_ = false;  // if it does not become complete
};

}  // namespace cradle
