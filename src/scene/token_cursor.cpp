#include "scene/token_cursor.h"

namespace cradle {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::string_view kDelimiters = " \t\r\n,:[]{}\"/";

bool isOneOf(char character, std::string_view characters) {
  return characters.find(character) != characters.npos;
}

// Bytes 10xxxxxx continue a character of UTF-8.
bool startsCharacter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

}  // namespace

TokenCursor::TokenCursor(std::string_view text) : text_(text) {
  if (text.starts_with(kByteOrderMark)) offset_ = kByteOrderMark.size();
}

void TokenCursor::passByte() {
  const char byte = text_[offset_++];
  if (byte == '\n') {
    ++place_.line;
    place_.column = 1;
  } else if (startsCharacter(byte)) {
    ++place_.column;
  }
}

void TokenCursor::passComment() {
  const bool isBlock = rest().starts_with("/*");
  passByte();
  passByte();
  while (offset_ < text_.size()) {
    if (isBlock && rest().starts_with("*/")) {
      passByte();
      passByte();
      return;
    }
    if (!isBlock && isOneOf(text_[offset_], "\r\n")) return;
    passByte();
  }
}

TextPlace TokenCursor::findToken() {
  followsComma_ = false;
  while (offset_ < text_.size()) {
    const char byte = text_[offset_];
    if (rest().starts_with("/*") && rest().find("*/", 2) == text_.npos) break;  // a fault, at its start
    if (rest().starts_with("//") || rest().starts_with("/*")) {
      passComment();
    } else if (byte == ',' || byte == ':') {
      followsComma_ = byte == ',';
      passByte();
    } else if (isOneOf(byte, kBlanks)) {
      passByte();
    } else {
      break;
    }
  }
  return place_;
}

void TokenCursor::passString() {
  passByte();
  while (offset_ < text_.size()) {
    const char byte = text_[offset_];
    passByte();
    if (byte == '"') return;
    if (byte == '\\' && offset_ < text_.size()) passByte();
  }
}

TextPlace TokenCursor::takeToken() {
  const TextPlace place = takenPlace_ = findToken();
  takenOffset_ = offset_;
  if (offset_ == text_.size()) return place;
  const char first = text_[offset_];
  if (first == '"') {
    passString();
  } else {
    passByte();
    if (isOneOf(first, kDelimiters)) return place;
    while (offset_ < text_.size() && !isOneOf(text_[offset_], kDelimiters)) passByte();
  }
  return place;
}

void TokenCursor::returnToTokenWith(std::size_t offset) {
  if (offset < takenOffset_ || offset >= offset_) return;
  offset_ = takenOffset_;
  place_ = takenPlace_;
}

TextPlace TokenCursor::advanceTo(std::size_t offset) {
  while (offset_ < offset && offset_ < text_.size()) passByte();
  return place_;
}

}  // namespace cradle
