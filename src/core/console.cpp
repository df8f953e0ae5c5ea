#include "core/console.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "core/error.h"

namespace cradle {
namespace {

/// The least character of each length in UTF-8: shorter ones written longer are not allowed. (RFC 3629, section 3)
constexpr std::array<char32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};

/// Number of bytes that the first byte of a character announces; 0: none begins so.
std::size_t announcedLength(unsigned char first) {
  if (first < 0x80) return 1;
  if (first < 0xc0) return 0;
  return first < 0xe0 ? 2 : first < 0xf0 ? 3 : first < 0xf8 ? 4 : 0;
}

bool isShown(char32_t character, std::size_t length) {
  const bool isSurrogate = character >= 0xd800 && character < 0xe000;
  const bool isControl = (character < 0x20 && character != '\n') || (character >= 0x7f && character < 0xa0);
  return character >= kLeast[length] && character <= 0x10ffff && !isSurrogate && !isControl;
}

/// Number of bytes of the character that `text` begins with; 0 if it is none that is shown.
std::size_t shownLength(std::string_view text) {
  const std::size_t length = announcedLength(static_cast<unsigned char>(text[0]));
  if (length == 0 || length > text.size()) return 0;
  char32_t character = length == 1 ? static_cast<unsigned char>(text[0]) : text[0] & (0x7f >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((text[i] & 0xc0) != 0x80) return 0;
    character = character << 6 | static_cast<char32_t>(text[i] & 0x3f);
  }
  return isShown(character, length) ? length : 0;
}

/// Nobody reads any more: what came through was what the reader wanted.
void requireOutput(bool isWritten) {
  if (isWritten || errno == EPIPE) return;
  throw Error(ErrorKind::output, "standard output", fmt::format("cannot be written: {}", std::strerror(errno)));
}

}  // namespace

std::string printable(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const std::size_t length = shownLength(text);
    if (length > 0)
      shown += text.substr(0, length);
    else
      shown += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return shown;
}

void showText(std::FILE* file, std::string_view text) {
  const std::string shown = printable(text);
  const bool isWritten = std::fwrite(shown.data(), 1, shown.size(), file) == shown.size();
  if (file == stdout) requireOutput(isWritten);
}

void flushOutput() {
  requireOutput(std::fflush(stdout) == 0);
}

}  // namespace cradle
