// Normal numbers are quantiles of uniform ones, and rotations a map of the unit cube that keeps volumes (K. Shoemake,
// "Uniform random rotations", Graphics Gems III, 1992): each draw is a smooth function of numbers in (0, 1), so that a
// small step of those is a small step of the scene.

#include "scene/draws.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "math/elementary.h"
#include "math/random_stream.h"
#include "scene/ranges.h"
#include "scene/read_fields.h"

namespace cradle {
namespace {

constexpr const char* kDrawKey = "draw";
constexpr const char* kMaterials = "/materials";  // whose keys are names: "draw" is one like others there

bool isDraw(const JsonValue& value, const std::string& pointer) {
  return pointer != kMaterials && memberOf(value, kDrawKey) != nullptr;
}

/// Calls visit(value, pointer) for a value and all in it, from outside to inside.
template <class Visit>
void visitAll(const JsonValue& value, const std::string& pointer, const Visit& visit) {
  visit(value, pointer);
  if (const auto* array = std::get_if<JsonValue::Array>(&value.content))
    for (std::size_t i = 0; i < array->size(); ++i) visitAll((*array)[i], pointerTo(pointer, i), visit);
  if (const auto* object = std::get_if<JsonValue::Object>(&value.content))
    for (const JsonMember& member : *object) visitAll(member.value, pointerTo(pointer, member.key), visit);
}

/// Two numbers, or arrays of them with one shape, for which isAllowed(first, second) holds.
template <class IsAllowed>
void checkPair(const Field& first, const Field& second, const char* allowed, const IsAllowed& isAllowed,
               FaultList& faults) {
  if (std::holds_alternative<JsonValue::Array>(first.value->content)) {
    const std::vector<Field> firsts = readItems(first, faults);
    const std::vector<Field> seconds = readItems(second, firsts.size(), faults);
    for (std::size_t i = 0; i < seconds.size(); ++i) checkPair(firsts[i], seconds[i], allowed, isAllowed, faults);
    return;
  }
  const auto a = readNumber(first, kAnyNumber, "", faults), b = readNumber(second, kAnyNumber, "", faults);
  if (a && b && !isAllowed(*a, *b))
    addFault(faults, second, fmt::format("{} and {} are drawn between; {}", *a, *b, allowed));
}

void checkUniform(const Field& field, FaultList& faults) {
  const std::vector<Field> ends = readItems(field, 2, faults);
  if (ends.empty()) return;
  checkPair(
      ends[0], ends[1], "allowed is [low, high] with low <= high, and no farther apart than a number is large",
      [](double low, double high) { return low <= high && std::isfinite(high - low); }, faults);
}

void checkNormal(const Field& field, FaultList& faults) {
  const std::vector<Field> parts = readItems(field, 2, faults);
  if (parts.empty()) return;
  constexpr double kMaxDeviation = 1e300;  // ten of which are a number, too
  checkPair(
      parts[0], parts[1], "allowed is [mean, deviation] with a deviation from 0 to 1e300",
      [](double mean, double deviation) {
        return deviation >= 0 && deviation <= kMaxDeviation && std::abs(mean) <= kMaxDeviation;
      },
      faults);
}

void checkChoice(const Field& field, FaultList& faults) {
  const auto* values = std::get_if<JsonValue::Array>(&field.value->content);
  if (values == nullptr || values->empty())
    addFault(faults, field,
             fmt::format("choice is {}; allowed is an array of at least one value", described(*field.value)));
}

void checkDraw(const Field& field, FaultList& faults) {
  ObjectReader reader(field, faults);
  const Field draw = *reader.find(kDrawKey);
  reader.rejectUnknownKeys();
  if (const auto* word = std::get_if<std::string>(&draw.value->content)) {
    if (*word != "rotation")
      addFault(faults, draw,
               fmt::format("draw is {}; allowed are \"rotation\", uniform, normal and choice", inQuotes(*word)));
    return;
  }
  ObjectReader kinds(draw, faults);
  const auto uniform = kinds.find("uniform"), normal = kinds.find("normal"), choice = kinds.find("choice");
  const int given = int(uniform.has_value()) + int(normal.has_value()) + int(choice.has_value());
  if (given != 1) {
    const std::string what =
        fmt::format("a draw has {} distributions; allowed is one of uniform, normal and choice", given);
    if (given == 0)
      kinds.addMissing({"uniform", "normal", "choice"}, what);
    else
      addFault(faults, draw, what);
  }
  if (uniform) checkUniform(*uniform, faults);
  if (normal) checkNormal(*normal, faults);
  if (choice) checkChoice(*choice, faults);
  kinds.rejectUnknownKeys();
}

JsonValue numberAt(const TextPlace& place, double number) {
  return {place, number};
}

/// Makes the draws of a tree.
class Drawing {
 public:
  explicit Drawing(const UniformSource& uniform) : uniform_(uniform) {}

  /// `pointer` becomes that of the value which a choice takes.
  JsonValue made(const JsonValue& value, std::string& pointer);
  /// With the origins of `bodies`.
  JsonValue madeDocument(const JsonValue& document);

  std::vector<DrawnValue> values;
  std::vector<std::string> bodyOrigins;

 private:
  JsonValue elementsOf(const JsonValue& array, const std::string& pointer);
  JsonValue membersOf(const JsonValue& object, const std::string& pointer);
  JsonValue drawnAt(const JsonValue& draw, std::string& pointer);
  JsonValue chosen(const JsonValue& choice, std::string& pointer);
  JsonValue rotation(const TextPlace& place, const std::string& pointer) const;
  /// Both numbers, or arrays with one shape, put together by make(first, second, uniform).
  template <class Make>
  JsonValue combined(const JsonValue& first, const JsonValue& second, const TextPlace& place,
                     const std::string& pointer, const Make& make, std::size_t& index) const;

  const UniformSource& uniform_;
  std::vector<std::string>* origins_ = nullptr;  // of the elements of the next array
};

template <class Make>
JsonValue Drawing::combined(const JsonValue& first, const JsonValue& second, const TextPlace& place,
                            const std::string& pointer, const Make& make, std::size_t& index) const {
  if (const auto* firsts = std::get_if<JsonValue::Array>(&first.content)) {
    JsonValue::Array values;
    for (std::size_t i = 0; i < firsts->size(); ++i)
      values.push_back(
          combined((*firsts)[i], std::get<JsonValue::Array>(second.content)[i], place, pointer, make, index));
    return {place, std::move(values)};
  }
  return numberAt(place,
                  make(std::get<double>(first.content), std::get<double>(second.content), uniform_(pointer, index++)));
}

JsonValue Drawing::rotation(const TextPlace& place, const std::string& pointer) const {
  const double split = uniform_(pointer, 0);
  const SinCos first = sinCos(2 * std::numbers::pi * uniform_(pointer, 1));
  const SinCos second = sinCos(2 * std::numbers::pi * uniform_(pointer, 2));
  const double near = std::sqrt(1 - split), far = std::sqrt(split);
  const std::array<std::pair<const char*, double>, 4> parts = {
      {{"w", far * second.cos}, {"x", near * first.sin}, {"y", near * first.cos}, {"z", far * second.sin}}};
  JsonValue::Object quaternion;
  for (const auto& [key, part] : parts) quaternion.push_back({key, place, numberAt(place, part)});
  return {place, std::move(quaternion)};
}

JsonValue Drawing::chosen(const JsonValue& choice, std::string& pointer) {
  const auto& values = std::get<JsonValue::Array>(choice.content);
  const std::size_t number =
      std::min(static_cast<std::size_t>(uniform_(pointer, 0) * static_cast<double>(values.size())), values.size() - 1);
  pointer = pointerTo(pointerTo(pointerTo(pointer, kDrawKey), "choice"), number);
  return made(values[number], pointer);
}

JsonValue Drawing::drawnAt(const JsonValue& draw, std::string& pointer) {
  std::size_t index = 0;
  if (const JsonValue* choice = memberOf(draw, "choice")) return chosen(*choice, pointer);
  if (const JsonValue* uniform = memberOf(draw, "uniform")) {
    const auto& ends = std::get<JsonValue::Array>(uniform->content);
    const auto between = [](double low, double high, double share) { return low + share * (high - low); };
    return combined(ends[0], ends[1], draw.place, pointer, between, index);
  }
  if (const JsonValue* normal = memberOf(draw, "normal")) {
    const auto& parts = std::get<JsonValue::Array>(normal->content);
    const auto around = [](double mean, double deviation, double probability) {
      return mean + deviation * normalQuantile(probability);
    };
    return combined(parts[0], parts[1], draw.place, pointer, around, index);
  }
  return rotation(draw.place, pointer);
}

JsonValue Drawing::elementsOf(const JsonValue& array, const std::string& pointer) {
  std::vector<std::string>* origins = std::exchange(origins_, nullptr);
  const auto& values = std::get<JsonValue::Array>(array.content);
  JsonValue::Array elements;
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::string origin = pointerTo(pointer, i);
    const bool isOptional = isDraw(values[i], origin);
    JsonValue element = made(values[i], origin);
    if (isOptional && std::holds_alternative<std::nullptr_t>(element.content)) continue;
    elements.push_back(std::move(element));
    if (origins) origins->push_back(origin);
  }
  return {array.place, std::move(elements)};
}

JsonValue Drawing::membersOf(const JsonValue& object, const std::string& pointer) {
  JsonValue::Object members;
  for (const JsonMember& member : std::get<JsonValue::Object>(object.content)) {
    std::string inside = pointerTo(pointer, member.key);
    members.push_back({member.key, member.place, made(member.value, inside)});
  }
  return {object.place, std::move(members)};
}

JsonValue Drawing::made(const JsonValue& value, std::string& pointer) {
  if (isDraw(value, pointer)) {
    const std::size_t number = values.size();
    values.push_back({pointer, {}});
    JsonValue result = drawnAt(*memberOf(value, kDrawKey), pointer);
    values[number].value = result;
    return result;
  }
  if (std::holds_alternative<JsonValue::Array>(value.content)) return elementsOf(value, pointer);
  if (std::holds_alternative<JsonValue::Object>(value.content)) return membersOf(value, pointer);
  return value;
}

JsonValue Drawing::madeDocument(const JsonValue& document) {
  JsonValue result = document;
  auto* members = std::get_if<JsonValue::Object>(&result.content);
  std::string root;
  if (members == nullptr) return made(document, root);
  for (JsonMember& member : *members) {
    origins_ = member.key == "bodies" ? &bodyOrigins : nullptr;
    std::string inside = pointerTo("", member.key);
    member.value = made(member.value, inside);
  }
  return result;
}

}  // namespace

void checkDraws(const JsonValue& document, FaultList& faults) {
  if (isDraw(document, ""))
    return addFault(faults, {&document, ""}, "the scene as a whole is a draw; allowed are values in it");
  visitAll(document, "", [&](const JsonValue& value, const std::string& pointer) {
    if (isDraw(value, pointer)) checkDraw({&value, pointer}, faults);
  });
}

DrawPlace firstDraw(const JsonValue& document) {
  DrawPlace first;
  visitAll(document, "", [&](const JsonValue& value, const std::string& pointer) {
    if (first.value == nullptr && isDraw(value, pointer)) first = {&value, pointer};
  });
  return first;
}

std::vector<std::string> drawPlaces(const JsonValue& document) {
  std::vector<std::string> places;
  visitAll(document, "", [&](const JsonValue& value, const std::string& pointer) {
    if (isDraw(value, pointer)) places.push_back(pointer);
  });
  return places;
}

DrawnDocument drawn(const JsonValue& document, const UniformSource& uniform) {
  Drawing drawing(uniform);
  JsonValue result = drawing.madeDocument(document);
  return {std::move(result), std::move(drawing.values), std::move(drawing.bodyOrigins)};
}

}  // namespace cradle
