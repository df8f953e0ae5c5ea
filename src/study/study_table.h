#pragma once

#include <optional>
#include <string>
#include <vector>

#include "study/work_precision.h"

namespace cradle {

/// The first line of study.csv, with the newline.
extern const char* const kStudyColumns;

/// A row as study.csv has it, with the newline; numbers read back to the same bits, `nan` where there is none.
std::string tableLine(const StudyRow& row);

/// The row of such a line's fields; nothing if they are not one. It has no message.
std::optional<StudyRow> rowOf(const std::vector<std::string>& fields);

}  // namespace cradle
