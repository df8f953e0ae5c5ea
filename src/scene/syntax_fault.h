#pragma once

#include <cstddef>
#include <string>

namespace cradle {

/// Bytes of the text that explainSyntaxFault wants to see.
constexpr std::size_t kLongestOffender = 40;

/// What is wrong where a text stops being JSON. `rest` is the text from the offending token on, empty at the end of the
/// text; `reason` is the parser's own message.
std::string explainSyntaxFault(const std::string& rest, bool followsComma, const std::string& reason);

}  // namespace cradle
