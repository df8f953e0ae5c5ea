#pragma once

#include <string>
#include <variant>
#include <vector>

#include "scene/fault_list.h"
#include "scene/text_place.h"

namespace cradle {

struct JsonMember;

/// A value of a JSON text that knows where it stands. Integers are numbers like all others.
struct JsonValue {
  using Array = std::vector<JsonValue>;
  using Object = std::vector<JsonMember>;  // in the order of the text

  TextPlace place;
  std::variant<std::nullptr_t, bool, double, std::string, Array, Object> content;
};

struct JsonMember {
  std::string key;
  TextPlace place;  // of the key
  JsonValue value;
};

/// The member of an object with that key; null if there is none, or the value is no object.
const JsonValue* memberOf(const JsonValue& value, const std::string& key);
JsonValue* memberOf(JsonValue& value, const std::string& key);

/// Reads a JSON text; // and /* */ comments and a byte order mark are allowed. Duplicate keys are added to `faults`
/// (the first one is kept). A text that is no JSON, nests deeper than 64 levels or is longer than 64 MB ends the
/// reading: throws Error(scene) with all faults so far. Numbers are finite.
JsonValue readJson(const std::string& text, FaultList& faults);

/// A text that readJson() reads as the same tree: numbers have the fewest digits that give them back (17 at most),
/// arrays of no more than numbers and words stand on one line.
std::string writeJson(const JsonValue& value);

/// The largest text that is read, in bytes.
constexpr std::size_t kLongestText = 64'000'000;

/// `pointer` and one more step down, escaped as RFC 6901 asks.
std::string pointerTo(const std::string& pointer, const std::string& key);
std::string pointerTo(const std::string& pointer, std::size_t index);

}  // namespace cradle
