#include "scene/fault_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace cradle {
namespace {

constexpr std::size_t kMostFaults = 50;        // more than anyone reads at once
constexpr std::size_t kLongestQuotation = 60;  // bytes of the user's text in a message

// Length of the well-formed character of UTF-8 that starts at `i`, or 0. Overlong forms and surrogates pass: they are
// shown, not interpreted.
std::size_t characterLength(const std::string& text, std::size_t i) {
  const auto lead = static_cast<unsigned char>(text[i]);
  const std::size_t length = lead < 0x80 ? 1 : lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : lead >= 0xC0 ? 2 : 0;
  if (i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((static_cast<unsigned char>(text[i + k]) & 0xC0U) != 0x80U) return 0;
  }
  return length;
}

// Keeps a message on one line and harmless to a terminal.
std::string printable(const std::string& text, std::size_t longest) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    if (i >= longest) return result + "...";
    const std::size_t length = characterLength(text, i);
    const auto byte = static_cast<unsigned char>(text[i]);
    if (length == 0 || byte < 0x20 || byte == 0x7F) {
      result += fmt::format("\\x{:02x}", byte);
      ++i;
    } else {
      result += text.substr(i, length);
      i += length;
    }
  }
  return result;
}

}  // namespace

void FaultList::add(const TextPlace& place, const std::string& pointer, const std::string& what) {
  if (!isFull()) faults_.push_back({place, where(place, pointer) + ": " + what});
  ++count_;
}

bool FaultList::isFull() const {
  return faults_.size() == kMostFaults;
}

std::string FaultList::where(const TextPlace& place, const std::string& pointer) const {
  const std::string position = fmt::format("{}:{}:{}", file_, place.line, place.column);
  return pointer.empty() ? position : position + " " + printable(pointer, 200);
}

void FaultList::throwIfAny(ErrorKind kind) const {
  if (count_ == 0) return;
  std::vector<Fault> sorted = faults_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Fault& a, const Fault& b) {
    return std::tie(a.place.line, a.place.column) < std::tie(b.place.line, b.place.column);
  });
  std::string text;
  for (const Fault& fault : sorted) text += (text.empty() ? "" : "\n") + fault.line;
  if (count_ > sorted.size()) text += fmt::format("\nand {} more", count_ - sorted.size());
  throw Error(kind, "", text);
}

std::string inQuotes(const std::string& text) {
  return '"' + printable(text, kLongestQuotation) + '"';
}

}  // namespace cradle
