#pragma once

#include <optional>
#include <string>
#include <utility>

namespace cradle {

/// Two whole numbers around a separator; nothing else. One too large for its type is the largest that is not.
std::optional<std::pair<long, long>> parsePair(const std::string& text, char separator);

}  // namespace cradle
