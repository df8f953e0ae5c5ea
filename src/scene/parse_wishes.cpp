#include "scene/parse_wishes.h"

#include <fmt/format.h>

namespace cradle {
namespace {

constexpr Range kDeviations{1e-9, 1e9};  // rad, or m

InsideWish parseInside(const Field& field, int body, FaultList& faults) {
  ObjectReader reader(field, faults);
  InsideWish inside;
  inside.body = body;
  const auto least = reader.require("min"), most = reader.require("max");
  if (least) inside.min = readVector(*least, kCoordinates, "m", faults).value_or(inside.min);
  if (most) inside.max = readVector(*most, kCoordinates, "m", faults).value_or(inside.max);
  if (least && most && (inside.min.array() > inside.max.array()).any())
    addFault(faults, *most, "max is below min; allowed is a box from its lowest to its highest corner");
  reader.rejectUnknownKeys();
  return inside;
}

ContactWish parseContact(const Field& field, const SceneDraft& draft, FaultList& faults) {
  const std::vector<Field> names = readItems(field, 2, faults);
  if (names.empty()) return {};
  const auto a = findNamed(names[0], draft.bodyIndex, "body", faults);
  const auto b = findNamed(names[1], draft.bodyIndex, "body", faults);
  if (a && b && *a == *b) addFault(faults, field, "a body cannot touch itself; name two");
  return {a.value_or(0), b.value_or(0)};
}

/// The time of a wish; infinite: the end.
double parseTime(const Field& field, double duration, FaultList& faults) {
  const auto* word = std::get_if<std::string>(&field.value->content);
  if (word != nullptr && *word == "end") return std::numeric_limits<double>::infinity();
  if (word != nullptr) addFault(faults, field, fmt::format("at is \"{}\"; allowed are \"end\" and times in s", *word));
  return word != nullptr ? 0 : readNumber(field, Range{0, duration}, "s", faults).value_or(0);
}

/// The index of a body that has more than one place.
int movingBody(const Field& field, const SceneDraft& draft, FaultList& faults) {
  const auto index = findNamed(field, draft.bodyIndex, "body", faults);
  if (!index) return 0;
  if (draft.scene.bodies[static_cast<std::size_t>(*index)].motion == Motion::fixed)
    addFault(faults, field, "a body that never moves; wish something of one that does");
  return *index;
}

Wish parseWish(const Field& field, const SceneDraft& draft, FaultList& faults) {
  ObjectReader reader(field, faults);
  Wish wish;
  wish.where = faults.where(field.place(), field.pointer);
  const auto body = reader.find("body"), up = reader.find("up"), inside = reader.find("inside"),
             contact = reader.find("contact"), at = reader.find("at");
  const int kinds = int(up.has_value()) + int(inside.has_value()) + int(contact.has_value());
  const std::string what = fmt::format("a wish says {} of up, inside and contact; allowed is one",
                                       reader.keysFound({"up", "inside", "contact"}));
  if (kinds == 0) reader.addMissing({"up", "inside", "contact"}, what);
  if (kinds > 1) addFault(faults, field, what);
  if (contact && body) addFault(faults, *body, "a wish for contact names both bodies in `contact`; leave body out");
  if (contact && at) addFault(faults, *at, "a wish for contact is met at any time; leave at out");
  const int index = body ? movingBody(*body, draft, faults) : 0;
  if (!body && !contact && kinds > 0) reader.addMissing({"body"}, "a wish names no body");
  if (at) wish.time = parseTime(*at, draft.scene.duration, faults);
  if (up) wish.kind = UpWish{index, readDirection(*up, faults).value_or(Vec3::UnitY())};
  if (inside) wish.kind = parseInside(*inside, index, faults);
  if (contact) wish.kind = parseContact(*contact, draft, faults);
  if (const auto deviation = reader.require("deviation"))
    wish.deviation = readNumber(*deviation, kDeviations, up ? "rad" : "m", faults).value_or(1);
  reader.rejectUnknownKeys();
  return wish;
}

}  // namespace

void parseWishes(ObjectReader& root, SceneDraft& draft) {
  for (const Field& item : root.items("wishes")) draft.scene.wishes.push_back(parseWish(item, draft, root.faults()));
}

}  // namespace cradle
