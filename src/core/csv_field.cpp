// RFC 4180, section 2, rules 5 to 7; lines end with a line feed alone.

#include "core/csv_field.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/printable.h"

namespace cradle {
namespace {

// Of spreadsheets; those that have a wide form, too.
constexpr std::string_view kFormulaStarts = "=+-@\t\r\n";
constexpr std::array<std::string_view, 4> kWideStarts = {"\uff1d", "\uff0b", "\uff0d", "\uff20"};

/// A formula, or what csvField() has made of one: so that it can be taken back.
bool needsApostrophe(std::string_view text) {
  const std::size_t start = text.find_first_not_of('\'');
  if (start == text.npos) return false;
  const auto isStart = [&](std::string_view wide) { return text.substr(start).starts_with(wide); };
  return kFormulaStarts.find(text[start]) != kFormulaStarts.npos || std::ranges::any_of(kWideStarts, isStart);
}

std::string withoutApostrophe(const std::string& field) {
  return field.starts_with('\'') && needsApostrophe(field) ? field.substr(1) : field;
}

}  // namespace

std::string csvField(const std::string& text) {
  const std::string plain = (needsApostrophe(text) ? "'" : "") + printableLine(text);
  if (plain.find_first_of(",\"") == std::string::npos) return plain;
  std::string field = "\"";
  for (const char c : plain) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

CsvLines csvLines(const std::string& table) {
  CsvLines found;
  std::vector<std::string> line(1);
  bool isQuoted = false;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const char c = table[i];
    if (c == '"' && isQuoted && i + 1 < table.size() && table[i + 1] == '"') {
      line.back() += table[++i];
    } else if (c == '"') {
      isQuoted = !isQuoted;
    } else if (isQuoted || (c != ',' && c != '\n')) {
      line.back() += c;
    } else {
      line.back() = withoutApostrophe(line.back());
      if (c == ',') {
        line.emplace_back();
        continue;
      }
      found.lines.push_back(std::move(line));
      found.bytes = i + 1;
      line.assign(1, "");
    }
  }
  return found;
}

}  // namespace cradle
