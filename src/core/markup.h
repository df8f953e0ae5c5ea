#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace cradle {

/// A text as content or attribute of HTML and XML; what cannot be shown is escaped as printableLine() has it.
std::string escapedMarkup(std::string_view text);

/// RFC 4648, section 4.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace cradle
