#include "core/error.h"

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "core/crash.h"
#include "core/printable.h"

namespace cradle {

namespace {

/// Lines after the first are set in: no name in strangers' files makes a line that seems to be the program's own.
std::string setIn(const std::string& text) {
  constexpr std::string_view kMargin = "  ";
  std::string lines;
  for (std::size_t i = 0; i < text.size(); ++i) {
    lines += text[i];
    const bool goesOn = text[i] == '\n' && i + 1 < text.size();
    if (goesOn && !std::string_view(text).substr(i + 1).starts_with(kMargin)) lines += kMargin;
  }
  return lines;
}

}  // namespace

Error::Error(ErrorKind kind, const std::string& where, const std::string& what)
    : kind_(kind), message_((where.empty() ? "" : printableLine(where) + ": ") + setIn(printable(what))) {}

void failCheck(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "cradle: internal check failed: %s (%s:%d). This is a bug in cradle, not in your scene.\n",
               condition, file, line);
  removeRemains();
  std::_Exit(1);
}

}  // namespace cradle
