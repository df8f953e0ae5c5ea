#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace cradle {

/// A text as one field of a table of comma-separated values: in quotes where it has to be, and after an apostrophe
/// where spreadsheets would take it for a formula; what a terminal obeys or what is no UTF-8 is as printable() has it,
/// save tabs and carriage returns.
std::string csvField(const std::string& text);

/// The fields of a table, line by line, as they were before csvField(), save what printable() has changed.
struct CsvLines {
  std::vector<std::vector<std::string>> lines;
  std::size_t bytes = 0;  // that they take: a last line without its end is left out
};
CsvLines csvLines(const std::string& table);

}  // namespace cradle
