#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "math/types.h"
#include "scene/fault_list.h"
#include "scene/json_document.h"
#include "scene/ranges.h"

// Typed reading of JSON values. Whatever is wrong goes to the fault list; the reader then gets nothing, or the default,
// and goes on, so that one run finds all faults.

namespace cradle {

/// A value with its JSON pointer.
struct Field {
  const JsonValue* value = nullptr;
  std::string pointer;

  const TextPlace& place() const { return value->place; }
};

/// Adds a fault at the value of `field`.
void addFault(FaultList& faults, const Field& field, const std::string& what);

/// Adds a warning at the value of `field`.
void addWarning(FaultList& faults, const Field& field, const std::string& what);

/// "a string ("abc")": what a value is, for a message.
std::string described(const JsonValue& value);

/// `unit` is only for messages ("kg"; empty if there is none).
std::optional<double> readNumber(const Field& field, const Range& range, const char* unit, FaultList& faults);
std::optional<bool> readBoolean(const Field& field, FaultList& faults);
std::optional<std::string> readText(const Field& field, FaultList& faults);
/// A text that is shown wherever its owner is: of at most 250 characters.
std::optional<std::string> readName(const Field& field, FaultList& faults);
/// False, and a fault, if a name that stands as a key, at `field`, is longer.
bool checkName(const Field& field, const std::string& name, FaultList& faults);
/// Three numbers, each in `range`.
std::optional<Vec3> readVector(const Field& field, const Range& range, const char* unit, FaultList& faults);
/// Three numbers, not all zero, scaled to length 1.
std::optional<Vec3> readDirection(const Field& field, FaultList& faults);
/// "#rrggbb" as sRGB, 0..1.
std::optional<Vec3f> readColor(const Field& field, FaultList& faults);
/// The elements of an array; none if it is no array, or one of more than a million.
std::vector<Field> readItems(const Field& field, FaultList& faults);
/// The same for an array that must have `count` elements.
std::vector<Field> readItems(const Field& field, std::size_t count, FaultList& faults);

/// An object of the scene file, asked key by key. The keys asked for are the keys it may have.
class ObjectReader {
 public:
  /// Anything but an object is a fault, and reads as an object without keys that misses none.
  ObjectReader(const Field& field, FaultList& faults);

  std::optional<Field> find(const char* key);
  /// A missing key is a fault.
  std::optional<Field> require(const char* key);
  /// Adds a fault of the object: it has none of `keys`, of which it needs one.
  void addMissing(std::vector<std::string> keys, const std::string& what);

  /// Adds a fault if the object has a key that others of its kind may have, and it may not; `why` says so.
  void refuse(const char* key, const std::string& why);

  /// Those of `keys` that the object has, for a message: "a" and "b"; "none of its keys".
  std::string keysFound(const std::vector<const char*>& keys);

  double number(const char* key, const Range& range, const char* unit, double fallback);
  std::optional<double> optionalNumber(const char* key, const Range& range, const char* unit);
  int integer(const char* key, int least, int most, int fallback);
  bool boolean(const char* key, bool fallback);
  std::string text(const char* key, const std::string& fallback);
  std::string name(const char* key, const std::string& fallback);
  Vec3 vector(const char* key, const Range& range, const char* unit, const Vec3& fallback);
  Vec3 direction(const char* key, const Vec3& fallback);
  std::optional<Vec3f> color(const char* key);
  std::vector<Field> items(const char* key);
  /// One of some words.
  template <typename T>
  T choice(const char* key, const std::vector<std::pair<const char*, T>>& words, T fallback);

  /// To be called last: every key that was never asked for is a fault. One that is like a missing key is the same fault
  /// as that.
  void rejectUnknownKeys();

  const Field& field() const { return field_; }
  FaultList& faults() const { return faults_; }

 private:
  const JsonMember* memberOf(const std::string& key) const;
  std::size_t choiceIndex(const Field& field, const std::vector<std::string>& words);
  void rejectUnknown(const JsonMember& member);

  struct Missing {
    std::vector<std::string> keys;
    std::size_t fault;  // its number
  };

  Field field_;
  const JsonValue::Object* object_;  // null if the value is no object
  FaultList& faults_;
  std::vector<std::string> known_, refused_;
  std::vector<Missing> missing_;
};

template <typename T>
T ObjectReader::choice(const char* key, const std::vector<std::pair<const char*, T>>& words, T fallback) {
  const auto found = find(key);
  if (!found) return fallback;
  std::vector<std::string> names;
  for (const auto& [name, value] : words) names.emplace_back(name);
  const std::size_t index = choiceIndex(*found, names);
  return index < words.size() ? words[index].second : fallback;
}

}  // namespace cradle
