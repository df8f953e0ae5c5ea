#pragma once

#include <string>
#include <string_view>

namespace cradle {

/// `text` with nothing that a terminal obeys or that hides: control characters (save line feeds), marks that turn the
/// direction of writing, and bytes that are no UTF-8, as \x1b. Names in strangers' files may hold such.
std::string printable(std::string_view text);

/// The same on one line; "..." is in place of what comes after `longest` bytes.
std::string printableLine(std::string_view text, std::size_t longest = std::string_view::npos);

/// Whether `text` begins with a character of UTF-8.
bool startsAsUtf8(std::string_view text);

}  // namespace cradle
