#include "scene/parse_pushes.h"

#include <fmt/format.h>

#include "scene/picked_points.h"

namespace cradle {
namespace {

Push::Ray parseRay(const Field& field, FaultList& faults) {
  ObjectReader reader(field, faults);
  Push::Ray ray;
  ray.origin = reader.vector("origin", kCoordinates, "m", Vec3(0, 0, 5));
  ray.direction = reader.direction("direction", -Vec3::UnitZ());
  reader.rejectUnknownKeys();
  return ray;
}

// A body point, the ray that finds one, or what a pixel shows.
void parsePoint(ObjectReader& reader, Push& push, PushDraft& draft) {
  const auto point = reader.find("point"), ray = reader.find("ray"), pick = reader.find("pick");
  if (point) push.target = readVector(*point, kCoordinates, "m", reader.faults()).value_or(Vec3::Zero());
  if (ray) push.target = parseRay(*ray, reader.faults());
  if (pick) draft.pick = parsePick(*pick, reader.faults());
  const int given = (point ? 1 : 0) + (ray ? 1 : 0) + (pick ? 1 : 0);
  if (given > 1) {
    addFault(reader.faults(), ray ? *ray : *pick,
             fmt::format("both {} are given; allowed is one of them", reader.keysFound({"point", "ray", "pick"})));
  } else if (given == 0) {
    reader.addMissing(
        {"point", "ray", "pick", "torque"},
        "the push does not say where it acts; give \"point\" (of the body), \"ray\" (of the world), \"pick\" (from a "
        "picture), or a \"torque\"");
  }
}

// A torque, which needs no point, or a force at one.
void parseAction(ObjectReader& reader, Push& push, PushDraft& draft) {
  const auto torque = reader.find("torque");
  if (!torque) {
    parsePoint(reader, push, draft);
    push.force = reader.vector("force", kForces, "N", Vec3(0, 0, -3));
    return;
  }
  push.torque = readVector(*torque, kForces, "N m", reader.faults());
  for (const char* key : {"force", "point", "ray", "pick"})
    if (const auto other = reader.find(key))
      addFault(reader.faults(), *other,
               fmt::format("both torque and {} are given; a torque acts on the whole body and has no {}", key, key));
}

/// A fault if it is moved by what it is told alone, and a warning if by nothing; at `name` or `field`.
void checkThatItMoves(const Push& push, const Field& field, const Field& name, const Scene& scene, FaultList& faults) {
  const Body& body = scene.bodies[static_cast<std::size_t>(push.body)];
  if (body.motion == Motion::driven)
    addFault(faults, name,
             fmt::format("body {} is driven and moves as it is told, whatever pushes it; push a dynamic body, or give "
                         "this one the motion",
                         inQuotes(body.name)));
  if (body.motion == Motion::fixed)
    addWarning(faults, field, fmt::format("the push moves nothing, because body {} is static", inQuotes(body.name)));
}

/// The body that a push names; nothing where it may be left out, for what is seen or met tells it.
std::optional<int> parsePushedBody(ObjectReader& reader, const SceneDraft& scene) {
  const auto isFound = [&](const char* key) { return reader.find(key).has_value(); };
  const bool isTold = isFound("pick") || isFound("ray");
  const auto name = isTold ? reader.find("body") : reader.require("body");
  return name ? findNamed(*name, scene.bodyIndex, "body", reader.faults()) : std::nullopt;
}

Push parsePush(const Field& field, SceneDraft& scene, FaultList& faults) {
  Push push;
  PushDraft draft;
  draft.field = field;
  push.where = faults.where(field.place(), field.pointer);
  ObjectReader reader(field, faults);
  push.body = parsePushedBody(reader, scene).value_or(kWorld);
  const auto name = reader.find("body");
  draft.namesBody = name.has_value();
  const std::size_t faultsBefore = faults.count();
  if (push.body != kWorld) checkThatItMoves(push, field, *name, scene.scene, faults);
  if (faults.count() != faultsBefore) return push;  // what else the push says is of no account
  parseAction(reader, push, draft);
  push.start = reader.number("start", kInstants, "s", 0.5);
  push.duration = reader.number("duration", kPushDurations, "s", 0.02);
  reader.rejectUnknownKeys();
  if (push.start >= scene.scene.duration)
    addWarning(faults, reader.find("start").value_or(field),
               fmt::format("the push begins at {} s, when the run has ended ({} s), and moves nothing", push.start,
                           scene.scene.duration));
  draft.push = scene.scene.pushes.size();
  if (draft.pick || !draft.namesBody) scene.pushes.push_back(draft);
  return push;
}

}  // namespace

void parsePushes(ObjectReader& root, SceneDraft& draft) {
  for (const Field& item : root.items("pushes")) draft.scene.pushes.push_back(parsePush(item, draft, root.faults()));
}

void completePushes(SceneDraft& draft, FaultList& faults) {
  if (draft.pushes.size() > kMaxPicks)
    return addFault(
        faults, draft.pushes[kMaxPicks].field,
        fmt::format("from here on, more than {} pushes are picked, or have a ray and no body; name the body "
                    "and point of those that are left",
                    kMaxPicks));
  for (const PushDraft& found : draft.pushes) {
    Push& push = draft.scene.pushes[found.push];
    if (found.pick && found.namesBody) {
      if (const auto point = pickedPoint(*found.pick, push.body, draft.scene, faults)) push.target = *point;
      continue;
    }
    std::optional<Ray> ray;
    if (found.pick)
      ray = rayOf(*found.pick, draft.scene, faults);
    else if (const auto* given = std::get_if<Push::Ray>(&push.target))
      ray = Ray{given->origin, given->direction};
    if (!ray) continue;
    const std::optional<Anchor> met = firstMet(*ray, draft.scene);
    if (!met) {
      addFault(faults, found.field,
               "no body is where the push points at the start of the scene; aim at one, or name it");
      continue;
    }
    push.body = met->body;
    if (found.pick) push.target = met->point;
    checkThatItMoves(push, found.field, found.field, draft.scene, faults);
  }
}

}  // namespace cradle
