// RFC 3629 (UTF-8); Unicode Standard Annex 9, section 2 (marks of direction); Unicode Standard, section 23.2 and table
// 23-3 (format characters).

#include "core/printable.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace cradle {
namespace {

/// The least character of each length: shorter ones written longer are not allowed.
constexpr std::array<char32_t, 5> kMin{0, 0, 0x80, 0x800, 0x10000};

struct Character {
  std::size_t length = 0;  // bytes; 0: there is none
  char32_t number = 0;
};

/// Number of bytes that the first byte of a character announces; 0: none begins so.
std::size_t announcedLength(unsigned char first) {
  if (first < 0x80) return 1;
  if (first < 0xc0) return 0;
  return first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf8 ? 4 : 0;
}

Character characterAt(std::string_view text) {
  const std::size_t length = announcedLength(static_cast<unsigned char>(text[0]));
  if (length == 0 || length > text.size()) return {};
  char32_t number = length == 1 ? static_cast<unsigned char>(text[0]) : text[0] & (0x7f >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((text[i] & 0xc0) != 0x80) return {};
    number = number << 6 | static_cast<char32_t>(text[i] & 0x3f);
  }
  const bool isSurrogate = number >= 0xd800 && number < 0xe000;
  return number < kMin[length] || number > 0x10ffff || isSurrogate ? Character{} : Character{length, number};
}

bool isControl(char32_t number) {
  return number < 0x20 || (number >= 0x7f && number < 0xa0) || number == 0x2028 || number == 0x2029;
}

/// Marks of direction, the byte order mark, and characters without width that join no letters.
bool isHidden(char32_t number) {
  constexpr std::array<std::array<char32_t, 2>, 8> kHidden{{{0xad, 0xad},
                                                            {0x61c, 0x61c},
                                                            {0x180e, 0x180e},
                                                            {0x200b, 0x200b},
                                                            {0x200e, 0x200f},
                                                            {0x202a, 0x202e},
                                                            {0x2060, 0x206f},
                                                            {0xfeff, 0xfeff}}};
  const bool isTag = number >= 0xe0000 && number < 0xe0080;
  return isTag || std::any_of(kHidden.begin(), kHidden.end(),
                              [&](const auto& range) { return number >= range[0] && number <= range[1]; });
}

std::string shownText(std::string_view text, std::size_t longest, bool keepsLines) {
  std::string shown;
  for (std::size_t next = 0; next < text.size();) {
    if (next >= longest) return shown + "...";
    const auto [length, number] = characterAt(text.substr(next));
    const bool isKept = length > 0 && !isHidden(number) && (!isControl(number) || (keepsLines && number == '\n'));
    const std::size_t size = std::max<std::size_t>(length, 1);
    for (const char byte : text.substr(next, size))
      shown += isKept ? std::string(1, byte) : fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    next += size;
  }
  return shown;
}

}  // namespace

std::string printable(std::string_view text) {
  return shownText(text, text.npos, true);
}

std::string printableLine(std::string_view text, std::size_t longest) {
  return shownText(text, longest, false);
}

bool startsAsUtf8(std::string_view text) {
  return text.empty() || characterAt(text).length > 0;
}

}  // namespace cradle
