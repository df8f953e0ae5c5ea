#include "core/error.h"

#include "core/printable.h"

namespace cradle {

namespace {

// Bytes of a message, which a stranger's names are part of: a path, and what another message said of one.
constexpr std::size_t kLongestWhere = 4'500, kLongestWhat = 10'000;

}  // namespace

Error::Error(ErrorKind kind, const std::string& where, const std::string& what)
    : Error(kind,
            (where.empty() ? "" : printableLine(where, kLongestWhere) + ": ") + printableLine(what, kLongestWhat)) {}

Error Error::ofLines(ErrorKind kind, const std::string& lines) {
  return {kind, printable(lines)};
}

void failCheck(const char* condition, const char* file, int line) {
  throw FailedCheck(std::string("internal check failed: ") + condition + " (" + file + ":" + std::to_string(line) +
                    ")");
}

}  // namespace cradle
