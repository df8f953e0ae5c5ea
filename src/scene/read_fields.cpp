#include "scene/read_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <regex>

#include "scene/suggestion.h"

namespace cradle {
namespace {

constexpr double kFarEnd = 1e6;  // of a range: who has got a sign wrong need not know of it

constexpr std::ptrdiff_t kMaxName = 250;  // characters; a million copies have it a million times

constexpr std::size_t kMaxItems = 1'000'000;  // of an array; as many bodies as a scene may have

// "1e9" for 1000000000, "16384" for 16384.
std::string describedBound(double bound) {
  static const std::regex kExponent("e([-+])0*");
  const std::string shortened = fmt::format("{:g}", bound);
  if (std::strtod(shortened.c_str(), nullptr) != bound) return fmt::format("{}", bound);
  return std::regex_replace(std::regex_replace(shortened, kExponent, "e$1"), std::regex("e\\+"), "e");
}

// "a number in 1e-36..1e36 (kg)", "a whole number in 1..16384"; "a number > 0 (kg)" of a wrong sign, when the ends of
// the range are far away.
std::string describedRange(const Range& range, const char* unit, double number) {
  std::string text = range.wantsInteger ? "a whole number" : "a number";
  const bool hasMost = range.most != kUnbounded, hasLeast = range.least != -kUnbounded;
  const bool hasWrongSign = range.least > 0 ? number <= 0 : range.least == 0 && number < 0;
  if (hasWrongSign && range.most >= kFarEnd && !range.wantsInteger) {
    text += range.least > 0 ? " > 0" : " >= 0";
  } else if (hasLeast && hasMost && !range.excludesEnds) {
    text += fmt::format(" in {}..{}", describedBound(range.least), describedBound(range.most));
  } else {
    if (hasLeast) text += fmt::format(" {} {}", range.excludesEnds ? ">" : ">=", range.least);
    if (hasMost) text += fmt::format("{} {} {}", hasLeast ? " and" : "", range.excludesEnds ? "<" : "<=", range.most);
  }
  return *unit == 0 ? text : fmt::format("{} ({})", text, unit);
}

std::string joinedInQuotes(const std::vector<std::string>& words) {
  return fmt::format("\"{}\"", fmt::join(words, "\", \""));
}

// The key is named because the value alone may not say what it is for: "mass", or "gravity[1]" for an element.
std::string keyOf(const Field& field) {
  std::string path = field.pointer, indices;
  while (!path.empty()) {
    const auto slash = path.rfind('/');
    const std::string step = path.substr(slash + 1);
    path.resize(slash);
    if (step.find_first_not_of("0123456789") != step.npos) return step + indices;
    indices = fmt::format("[{}]{}", step, indices);
  }
  return "the scene" + indices;
}

int hexDigit(char character) {
  if (character >= '0' && character <= '9') return character - '0';
  if (character >= 'a' && character <= 'f') return character - 'a' + 10;
  if (character >= 'A' && character <= 'F') return character - 'A' + 10;
  return -1;
}

}  // namespace

void addFault(FaultList& faults, const Field& field, const std::string& what) {
  if (faults.isFull()) {
    faults.add({}, "", "");
  } else {
    faults.add(field.place(), field.pointer, what);
  }
}

void addWarning(FaultList& faults, const Field& field, const std::string& what) {
  faults.warn(field.place(), field.pointer, what);
}

std::string described(const JsonValue& value) {
  struct {
    std::string operator()(std::nullptr_t) const { return "null"; }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(double value) const { return fmt::format("the number {}", value); }
    std::string operator()(const std::string& value) const { return "the string " + inQuotes(value); }
    std::string operator()(const JsonValue::Array& value) const {
      return fmt::format("an array of {} element{}", value.size(), value.size() == 1 ? "" : "s");
    }
    std::string operator()(const JsonValue::Object&) const { return "an object"; }
  } describe;
  return std::visit(describe, value.content);
}

std::optional<double> readNumber(const Field& field, const Range& range, const char* unit, FaultList& faults) {
  const double* number = std::get_if<double>(&field.value->content);
  if (number != nullptr && range.holds(*number)) return *number;
  const std::string found = number == nullptr ? described(*field.value) : fmt::format("{}", *number);
  addFault(faults, field,
           fmt::format("{} is {}; allowed is {}", keyOf(field), found,
                       describedRange(range, unit, number == nullptr ? -1 : *number)));
  return std::nullopt;
}

std::optional<std::string> readText(const Field& field, FaultList& faults) {
  if (const auto* text = std::get_if<std::string>(&field.value->content)) return *text;
  addFault(faults, field, fmt::format("{} is {}; allowed is a string", keyOf(field), described(*field.value)));
  return std::nullopt;
}

std::optional<std::string> readName(const Field& field, FaultList& faults) {
  auto name = readText(field, faults);
  return name && checkName(field, *name, faults) ? name : std::nullopt;
}

bool checkName(const Field& field, const std::string& name, FaultList& faults) {
  const auto characters = std::count_if(name.begin(), name.end(), [](char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;  // 10xxxxxx continues one
  });
  if (characters <= kMaxName) return true;
  addFault(faults, field,
           fmt::format("the name {} has {} characters; at most {} are allowed", inQuotes(name), characters, kMaxName));
  return false;
}

std::optional<bool> readBoolean(const Field& field, FaultList& faults) {
  if (const auto* found = std::get_if<bool>(&field.value->content)) return *found;
  addFault(faults, field, fmt::format("{} is {}; allowed is true or false", keyOf(field), described(*field.value)));
  return std::nullopt;
}

std::optional<Vec3> readVector(const Field& field, const Range& range, const char* unit, FaultList& faults) {
  const std::vector<Field> items = readItems(field, 3, faults);
  if (items.empty()) return std::nullopt;
  Vec3 vector;
  bool isSound = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = readNumber(items[i], range, unit, faults);
    isSound = isSound && number.has_value();
    vector[static_cast<Eigen::Index>(i)] = number.value_or(0);
  }
  return isSound ? std::optional(vector) : std::nullopt;
}

std::optional<Vec3> readDirection(const Field& field, FaultList& faults) {
  const auto vector = readVector(field, kAnyNumber, "", faults);
  if (!vector) return std::nullopt;
  if (*vector != Vec3::Zero()) return vector->stableNormalized();
  addFault(faults, field, keyOf(field) + " is zero; allowed is any length but zero");
  return std::nullopt;
}

std::optional<Vec3f> readColor(const Field& field, FaultList& faults) {
  const auto text = readText(field, faults);
  if (!text) return std::nullopt;
  const bool isColor = text->size() == 7 && text->front() == '#' &&
                       std::all_of(text->begin() + 1, text->end(), [](char c) { return hexDigit(c) >= 0; });
  if (!isColor) {
    addFault(faults, field, fmt::format("{} is {}; allowed is \"#rrggbb\"", keyOf(field), inQuotes(*text)));
    return std::nullopt;
  }
  Vec3f color;
  for (std::size_t i = 0; i < 3; ++i) {
    const int level = 16 * hexDigit((*text)[2 * i + 1]) + hexDigit((*text)[2 * i + 2]);
    color[static_cast<Eigen::Index>(i)] = static_cast<float>(level) / 255.0F;
  }
  return color;
}

std::vector<Field> readItems(const Field& field, FaultList& faults) {
  const auto* array = std::get_if<JsonValue::Array>(&field.value->content);
  if (array == nullptr) {
    addFault(faults, field, fmt::format("{} is {}; allowed is an array", keyOf(field), described(*field.value)));
    return {};
  }
  if (array->size() > kMaxItems) {
    addFault(faults, field,
             fmt::format("{} has {} elements; at most {} are allowed", keyOf(field), array->size(), kMaxItems));
    return {};
  }
  std::vector<Field> items;
  for (std::size_t i = 0; i < array->size(); ++i) items.push_back({&(*array)[i], pointerTo(field.pointer, i)});
  return items;
}

namespace {

/// Of a number in place of a vector: the vector along y, which is up.
std::string asVector(const JsonValue& value, std::size_t count) {
  const auto* number = std::get_if<double>(&value.content);
  return number != nullptr && count == 3 ? fmt::format(", as [0, {}, 0]", *number) : "";
}

/// Of a name in place of an object: the object with that key.
std::string asObject(const JsonValue& value) {
  const auto* name = std::get_if<std::string>(&value.content);
  return name != nullptr ? fmt::format(", as {{{}: {{ }}}}", inQuotes(*name)) : "";
}

}  // namespace

std::vector<Field> readItems(const Field& field, std::size_t count, FaultList& faults) {
  const auto* array = std::get_if<JsonValue::Array>(&field.value->content);
  if (array != nullptr && array->size() == count) return readItems(field, faults);
  addFault(faults, field,
           fmt::format("{} is {}; allowed is an array of {} elements{}", keyOf(field), described(*field.value), count,
                       asVector(*field.value, count)));
  return {};
}

ObjectReader::ObjectReader(const Field& field, FaultList& faults)
    : field_(field), object_(std::get_if<JsonValue::Object>(&field.value->content)), faults_(faults) {
  if (object_ != nullptr) return;
  addFault(
      faults, field,
      fmt::format("{} is {}; allowed is an object{}", keyOf(field), described(*field.value), asObject(*field.value)));
}

std::optional<Field> ObjectReader::find(const char* key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.emplace_back(key);
  const JsonMember* member = memberOf(key);
  return member == nullptr ? std::nullopt : std::optional(Field{&member->value, pointerTo(field_.pointer, key)});
}

const JsonMember* ObjectReader::memberOf(const std::string& key) const {
  if (object_ == nullptr) return nullptr;
  const auto found =
      std::find_if(object_->begin(), object_->end(), [&key](const JsonMember& member) { return member.key == key; });
  return found == object_->end() ? nullptr : &*found;
}

std::string ObjectReader::keysFound(const std::vector<const char*>& keys) {
  std::vector<std::string> found;
  for (const char* key : keys)
    if (find(key)) found.push_back(inQuotes(key));
  return found.empty() ? "none of its keys" : fmt::format("{}", fmt::join(found, " and "));
}

void ObjectReader::refuse(const char* key, const std::string& why) {
  const JsonMember* member = memberOf(key);
  if (member == nullptr) return;
  refused_.emplace_back(key);
  faults_.add(member->place, pointerTo(field_.pointer, key), why);
}

std::optional<Field> ObjectReader::require(const char* key) {
  const auto found = find(key);
  if (!found) addMissing({key}, fmt::format("key \"{}\" is missing; it is required", key));
  return found;
}

void ObjectReader::addMissing(std::vector<std::string> keys, const std::string& what) {
  if (object_ == nullptr) return;
  missing_.push_back({std::move(keys), faults_.add(field_.place(), field_.pointer, what)});
}

double ObjectReader::number(const char* key, const Range& range, const char* unit, double fallback) {
  return optionalNumber(key, range, unit).value_or(fallback);
}

std::optional<double> ObjectReader::optionalNumber(const char* key, const Range& range, const char* unit) {
  const auto found = find(key);
  return found ? readNumber(*found, range, unit, faults_) : std::nullopt;
}

int ObjectReader::integer(const char* key, int least, int most, int fallback) {
  return static_cast<int>(number(key, {double(least), double(most), false, true}, "", fallback));
}

bool ObjectReader::boolean(const char* key, bool fallback) {
  const auto found = find(key);
  return found ? readBoolean(*found, faults_).value_or(fallback) : fallback;
}

std::string ObjectReader::text(const char* key, const std::string& fallback) {
  const auto found = find(key);
  return found ? readText(*found, faults_).value_or(fallback) : fallback;
}

std::string ObjectReader::name(const char* key, const std::string& fallback) {
  const auto found = find(key);
  return found ? readName(*found, faults_).value_or(fallback) : fallback;
}

Vec3 ObjectReader::vector(const char* key, const Range& range, const char* unit, const Vec3& fallback) {
  const auto found = find(key);
  return found ? readVector(*found, range, unit, faults_).value_or(fallback) : fallback;
}

Vec3 ObjectReader::direction(const char* key, const Vec3& fallback) {
  const auto found = find(key);
  return found ? readDirection(*found, faults_).value_or(fallback) : fallback;
}

std::optional<Vec3f> ObjectReader::color(const char* key) {
  const auto found = find(key);
  return found ? readColor(*found, faults_) : std::nullopt;
}

std::vector<Field> ObjectReader::items(const char* key) {
  const auto found = find(key);
  return found ? readItems(*found, faults_) : std::vector<Field>{};
}

std::size_t ObjectReader::choiceIndex(const Field& field, const std::vector<std::string>& words) {
  const auto text = readText(field, faults_);
  const auto found = text ? std::find(words.begin(), words.end(), *text) : words.end();
  if (text && found == words.end()) {
    addFault(faults_, field,
             fmt::format("{} is {}; allowed are {}{}", keyOf(field), inQuotes(*text), joinedInQuotes(words),
                         didYouMean(*text, words)));
  }
  return static_cast<std::size_t>(found - words.begin());
}

void ObjectReader::rejectUnknownKeys() {
  if (object_ == nullptr) return;
  for (const JsonMember& member : *object_) {
    const auto isAmong = [&member](const std::vector<std::string>& keys) {
      return std::find(keys.begin(), keys.end(), member.key) != keys.end();
    };
    if (isAmong(known_) || isAmong(refused_)) continue;
    if (faults_.isFull())
      faults_.add({}, "", "");
    else
      rejectUnknown(member);
  }
}

void ObjectReader::rejectUnknown(const JsonMember& member) {
  const std::string pointer = pointerTo(field_.pointer, member.key);
  const std::string what = fmt::format("unknown key {}; allowed are {}{}", inQuotes(member.key),
                                       fmt::join(known_, ", "), didYouMean(member.key, known_));
  const std::string* meant = mostLike(member.key, known_);
  const auto same = std::find_if(missing_.begin(), missing_.end(), [meant](const Missing& missing) {
    return meant && std::find(missing.keys.begin(), missing.keys.end(), *meant) != missing.keys.end();
  });
  if (same == missing_.end()) {
    faults_.add(member.place, pointer, what);
  } else {
    faults_.replace(same->fault, member.place, pointer, what);
    missing_.erase(same);
  }
}

}  // namespace cradle
