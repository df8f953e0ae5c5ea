#pragma once

#include <cstdio>
#include <string>

#include "study/work_precision.h"

namespace cradle {

/// A row as study.csv has it, with the newline; numbers read back to the same bits, `nan` where there is none.
std::string tableLine(const StudyRow& row);

/// study.csv while it grows: FILE.part holds all rows so far at any moment, and becomes FILE when complete.
class StudyTable {
 public:
  /// Throws Error(output) if it cannot be written; an earlier FILE.part is replaced.
  explicit StudyTable(const std::string& path);
  ~StudyTable();
  StudyTable(const StudyTable&) = delete;
  StudyTable& operator=(const StudyTable&) = delete;

  void append(const StudyRow& row);
  void complete();

 private:
  void write(const std::string& text);
  [[noreturn]] void fail() const;

  std::string path_;
  std::FILE* file_ = nullptr;
};

}  // namespace cradle
