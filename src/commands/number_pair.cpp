#include "commands/number_pair.h"

#include <charconv>
#include <limits>

namespace cradle {

std::optional<std::pair<long, long>> parsePair(const std::string& text, char separator) {
  std::pair<long, long> pair{std::numeric_limits<long>::max(), std::numeric_limits<long>::max()};
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, pair.first);
  if (first.ec == std::errc::invalid_argument || first.ptr == end || *first.ptr != separator) return std::nullopt;
  const auto second = std::from_chars(first.ptr + 1, end, pair.second);
  if (second.ec == std::errc::invalid_argument || second.ptr != end) return std::nullopt;
  return pair;
}

}  // namespace cradle
