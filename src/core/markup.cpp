#include "core/markup.h"

#include <algorithm>

#include "core/printable.h"

namespace cradle {

std::string escapedMarkup(std::string_view text) {
  // Of what is printable, XML 1.0 has no place for U+FFFE and U+FFFF.
  constexpr std::string_view kNoCharacter = "\xef\xbf";
  std::string result;
  const std::string shown = printableLine(text);
  for (std::size_t i = 0; i < shown.size(); ++i) switch (shown[i]) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        if (shown.compare(i, 2, kNoCharacter) == 0 && i + 2 < shown.size() && shown[i + 2] >= '\xbe') {
          result += shown[i + 2] == '\xbe' ? "\\ufffe" : "\\uffff";
          i += 2;
        } else {
          result += shown[i];
        }
    }
  return result;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace cradle
