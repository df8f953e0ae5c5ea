// A text as JSON: every value stands in the text, behind what holds it, and numbers are finite.

#include <cmath>

#include "fuzz_target.h"
#include "scene/json_document.h"

namespace cradle {
namespace {

constexpr int kDeepest = 64;  // levels

bool isBefore(const TextPlace& a, const TextPlace& b) {
  return a.line < b.line || (a.line == b.line && a.column < b.column);
}

void check(const JsonValue& value, std::uint32_t lines, int depth) {
  HOLDS(value.place.line >= 1 && value.place.line <= lines && value.place.column >= 1);
  HOLDS(depth <= kDeepest);
  if (const auto* number = std::get_if<double>(&value.content)) HOLDS(std::isfinite(*number));
  if (const auto* array = std::get_if<JsonValue::Array>(&value.content))
    for (const JsonValue& item : *array) {
      HOLDS(isBefore(value.place, item.place));
      check(item, lines, depth + 1);
    }
  if (const auto* object = std::get_if<JsonValue::Object>(&value.content))
    for (const JsonMember& member : *object) {
      HOLDS(isBefore(value.place, member.place) && isBefore(member.place, member.value.place));
      check(member.value, lines, depth + 1);
    }
}

}  // namespace
}  // namespace cradle

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cradle;
  acceptOrRefuse([&] {
    const std::string text = textOf(data, size);
    FaultList faults("text.json", ErrorKind::scene);
    const JsonValue document = readJson(text, faults);
    std::uint32_t lines = 1;
    for (const char byte : text) lines += byte == '\n' || byte == '\r';
    check(document, lines, 0);
  });
  return 0;
}
