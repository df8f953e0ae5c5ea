#include "scene/parse_bumps.h"

#include <numbers>

namespace cradle {
namespace {

constexpr Range kDeviations{0, 30};                             // degrees: three deviations are a right angle
constexpr Range kSeeds{0, 9'007'199'254'740'991, false, true};  // 2^53 - 1: whole numbers that a double holds

/// The index of a body that has impacts of its own.
int fallingBody(const Field& field, const SceneDraft& draft, FaultList& faults) {
  const auto index = findNamed(field, draft.bodyIndex, "body", faults);
  if (!index) return 0;
  if (draft.scene.bodies[static_cast<std::size_t>(*index)].motion != Motion::dynamic)
    addFault(faults, field, "a body that no impact moves; name one that strikes it");
  return *index;
}

BumpChange parseChange(const Field& field, const SceneDraft& draft, FaultList& faults) {
  ObjectReader reader(field, faults);
  BumpChange change;
  if (const auto body = reader.require("body")) change.body = fallingBody(*body, draft, faults);
  if (reader.require("impact")) change.impact = reader.integer("impact", 1, 1'000'000'000, 1);
  if (const auto seed = reader.require("seed"))
    change.seed = static_cast<std::uint64_t>(readNumber(*seed, kSeeds, "", faults).value_or(0));
  reader.rejectUnknownKeys();
  return change;
}

}  // namespace

void parseBumps(ObjectReader& root, SceneDraft& draft) {
  const auto field = root.find("bumps");
  if (!field) return;
  ObjectReader reader(*field, root.faults());
  Bumps bumps;
  if (reader.require("deviationDegrees"))
    bumps.deviation = reader.number("deviationDegrees", kDeviations, "degrees", 0) * std::numbers::pi / 180;
  bumps.seed = static_cast<std::uint64_t>(reader.number("seed", kSeeds, "", 0));
  for (const Field& item : reader.items("changes")) bumps.changes.push_back(parseChange(item, draft, root.faults()));
  reader.rejectUnknownKeys();
  draft.scene.bumps = std::move(bumps);
}

}  // namespace cradle
