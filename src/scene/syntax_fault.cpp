#include "scene/syntax_fault.h"

#include <array>
#include <string_view>

#include "core/printable.h"
#include "scene/fault_list.h"

namespace cradle {
namespace {

// What other languages write for numbers that JSON does not have.
constexpr std::array<std::string_view, 8> kNotFinite{"NaN", "nan",  "Infinity", "-Infinity",
                                                     "inf", "-inf", "-NaN",     "-nan"};

std::string firstWord(const std::string& rest) {
  return rest.substr(0, rest.find_first_of(" \t\r\n,]}"));
}

// "[...] parse error at line 1, column 2: syntax error while parsing value - REASON; last read: '...'; expected ..."
std::string shortened(const std::string& reason) {
  const auto dash = reason.find(" - ");
  const auto start = dash == reason.npos ? 0 : dash + 3;
  return reason.substr(start, reason.find("; last read", start) - start);
}

}  // namespace

std::string explainSyntaxFault(const std::string& rest, bool followsComma, const std::string& reason) {
  const std::string word = inQuotes(firstWord(rest));
  if (!startsAsUtf8(rest) && reason.find("UTF-8") == reason.npos)
    return word + " is no JSON, which is UTF-8; save the text as that";
  if (reason.find("invalid comment") != reason.npos) return "a comment has no end; /* needs a */";
  if (rest.empty()) return "the text ends too early; a scene is one JSON object, { ... }";
  for (const std::string_view name : kNotFinite) {
    if (rest.starts_with(name)) return word + " is no number of JSON; numbers must be finite";
  }
  if (reason.find("number overflow") != reason.npos) {
    return word + " is too large for a number; numbers must be finite, at most 1.8e308";
  }
  if (followsComma && (rest[0] == ']' || rest[0] == '}')) {
    return "a comma stands before a closing bracket; JSON allows commas only between values; remove it";
  }
  if (rest[0] == '\'') return word + " is no JSON; strings stand in double quotes";
  const std::string place = firstWord(rest).empty() ? "" : " at " + word;
  return "this is no JSON: " + shortened(reason) + place;
}

}  // namespace cradle
