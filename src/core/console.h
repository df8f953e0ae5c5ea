#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

namespace cradle {

/// Puts /dev/null, open for reading, in place of each standard file that is closed: what the program opens later does
/// not get its number, and standard output still cannot be written.
void fillStandardFiles();

/// Writes to standard output or standard error what printable() gives of it; nothing more once nobody reads there.
/// Throws Error(output) if standard output cannot be written.
void showText(std::FILE* file, std::string_view text);

/// As fmt::print, by showText.
template <class... Arguments>
void show(std::FILE* file, fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  showText(file, fmt::format(format, std::forward<Arguments>(arguments)...));
}
template <class... Arguments>
void show(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  showText(stdout, fmt::format(format, std::forward<Arguments>(arguments)...));
}

/// What was printed has left the program. Throws as showText does.
void flushOutput();

}  // namespace cradle
