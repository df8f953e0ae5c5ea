#include "scene/parse_captions.h"

#include <fmt/format.h>

namespace cradle {
namespace {

constexpr Range kCardSeconds{0.1, 60};  // s

std::string placeOf(const Field& field, const FaultList& faults) {
  return faults.where(field.place(), field.pointer);
}

/// A text that there is, and in `where` its place.
std::string requireWords(ObjectReader& reader, const char* key, std::string& where) {
  const auto field = reader.require(key);
  if (!field) return "";
  where = placeOf(*field, reader.faults());
  const auto words = readName(*field, reader.faults());
  if (words && words->find_first_not_of(' ') == std::string::npos)
    addFault(reader.faults(), *field, fmt::format("{} is empty; give the words to show", key));
  return words.value_or("");
}

Caption parseCaption(const Field& field, const SceneDraft& draft, FaultList& faults) {
  ObjectReader reader(field, faults);
  Caption caption;
  caption.text = requireWords(reader, "text", caption.where);
  caption.from = reader.number("from", kInstants, "s", caption.from);
  const auto to = reader.find("to");
  if (to) caption.to = readNumber(*to, kInstants, "s", faults).value_or(caption.to);
  if (caption.to <= caption.from)
    addFault(
        faults, *to,
        fmt::format("a caption that begins at {} s ends at {} s; allowed are later times", caption.from, caption.to));
  if (const auto body = reader.find("body"))
    caption.body = findNamed(*body, draft.bodyIndex, "body", faults).value_or(kWorld);
  reader.rejectUnknownKeys();
  return caption;
}

}  // namespace

void parseCaptions(ObjectReader& root, SceneDraft& draft) {
  for (const Field& item : root.items("captions"))
    draft.scene.captions.push_back(parseCaption(item, draft, root.faults()));
  const auto field = root.find("titleCard");
  if (!field) return;
  ObjectReader reader(*field, root.faults());
  TitleCard& card = draft.scene.titleCard.emplace();
  card.title = requireWords(reader, "title", card.titleWhere);
  card.subtitle = reader.name("subtitle", "");
  if (const auto subtitle = reader.find("subtitle")) card.subtitleWhere = placeOf(*subtitle, root.faults());
  card.seconds = reader.number("seconds", kCardSeconds, "s", card.seconds);
  reader.rejectUnknownKeys();
}

}  // namespace cradle
