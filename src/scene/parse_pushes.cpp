#include "scene/parse_pushes.h"

#include <fmt/format.h>

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

// A body point, or the ray that finds one.
void parsePoint(ObjectReader& reader, Push& push) {
  const auto point = reader.find("point"), ray = reader.find("ray");
  if (point) push.target = readVector(*point, kCoordinates, "m", reader.faults()).value_or(Vec3::Zero());
  if (ray) push.target = parseRay(*ray, reader.faults());
  if (point && ray) {
    addFault(reader.faults(), *ray, "both point and ray are given; allowed is one of them");
  } else if (!point && !ray) {
    reader.addMissing(
        {"point", "ray", "torque"},
        "the push does not say where it acts; give \"point\" (of the body) or \"ray\" (of the world), or a "
        "\"torque\"");
  }
}

// A torque, which needs no point, or a force at one.
void parseAction(ObjectReader& reader, Push& push) {
  const auto torque = reader.find("torque");
  if (!torque) {
    parsePoint(reader, push);
    push.force = reader.vector("force", kForces, "N", Vec3(0, 0, -3));
    return;
  }
  push.torque = readVector(*torque, kForces, "N m", reader.faults());
  for (const char* key : {"force", "point", "ray"})
    if (const auto other = reader.find(key))
      addFault(reader.faults(), *other,
               fmt::format("both torque and {} are given; a torque acts on the whole body and has no {}", key, key));
}

/// False if it does not and may not be pushed: what else the push says is of no account then.
bool checkThatItMoves(const Push& push, const Field& field, const Field& name, const Scene& scene, FaultList& faults) {
  const Body& body = scene.bodies[static_cast<std::size_t>(push.body)];
  if (body.motion == Motion::driven)
    addFault(faults, name,
             fmt::format("body {} is driven and moves as it is told, whatever pushes it; push a dynamic body, or give "
                         "this one the motion",
                         inQuotes(body.name)));
  if (body.motion == Motion::fixed)
    addWarning(faults, field, fmt::format("the push moves nothing, because body {} is static", inQuotes(body.name)));
  return body.motion != Motion::driven;
}

Push parsePush(const Field& field, const SceneDraft& scene, FaultList& faults) {
  Push push;
  push.where = faults.where(field.place(), field.pointer);
  ObjectReader reader(field, faults);
  const auto name = reader.require("body");
  const auto body = name ? findNamed(*name, scene.bodyIndex, "body", faults) : std::nullopt;
  push.body = body.value_or(kWorld);
  if (push.body != kWorld && !checkThatItMoves(push, field, *name, scene.scene, faults)) return push;
  parseAction(reader, push);
  push.start = reader.number("start", kInstants, "s", 0.5);
  push.duration = reader.number("duration", kPushDurations, "s", 0.02);
  reader.rejectUnknownKeys();
  if (push.start >= scene.scene.duration)
    addWarning(faults, reader.find("start").value_or(field),
               fmt::format("the push begins at {} s, when the run has ended ({} s), and moves nothing", push.start,
                           scene.scene.duration));
  return push;
}

}  // namespace

void parsePushes(ObjectReader& root, SceneDraft& draft) {
  for (const Field& item : root.items("pushes")) draft.scene.pushes.push_back(parsePush(item, draft, root.faults()));
}

}  // namespace cradle
