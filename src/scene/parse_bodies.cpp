#include "scene/parse_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/given_mass.h"
#include "scene/parse_copies.h"
#include "scene/parse_driven.h"
#include "scene/parse_pose.h"
#include "scene/parse_shape.h"

namespace cradle {
namespace {

// Of bodies that are near enough to touch, as plans have them (BroadPhase); and as many as links could take out.
constexpr double kMaxPairs = 2e6, kMaxLinks = 1e6;

void parseMaterialName(ObjectReader& reader, const SceneDraft& scene, BodyDraft& draft) {
  const auto field = reader.find("material");
  if (!field) return;
  draft.body.material = findNamed(*field, scene.materialIndex, "material", reader.faults()).value_or(0);
  draft.body.namesMaterial = true;
}

void parseName(ObjectReader& reader, BodyDraft& draft) {
  const auto field = reader.require("name");
  const auto name = field ? readName(*field, reader.faults()) : std::nullopt;
  if (name && name->empty()) addFault(reader.faults(), *field, "the name is empty; a body needs one");
  draft.body.name = name.value_or("");
}

void parseCategory(ObjectReader& reader, BodyDraft& draft) {
  const auto field = reader.find("category");
  if (!field) return;
  const auto category = readName(*field, reader.faults());
  if (category && category->empty())
    addFault(reader.faults(), *field, "the category is empty; leave it out, or name one");
  draft.body.category = category.value_or("");
}

// The mass and velocities of a body that no force moves go unused; its writer should know.
void warnOfUnused(ObjectReader& reader, const BodyDraft& draft) {
  if (draft.body.motion == Motion::dynamic) return;
  const bool isDriven = draft.body.motion == Motion::driven;
  std::vector<const char*> keys = {"massFrom", "thickness", "mass", "centerOfMass", "inertiaTensor"};
  if (!isDriven) keys.insert(keys.end(), {"linearVelocity", "angularVelocity", "angularVelocityBody"});
  for (const char* key : keys) {
    if (const auto field = reader.find(key))
      addWarning(reader.faults(), *field,
                 fmt::format("{} is not used, because the body is {}", key, isDriven ? "driven" : "static"));
  }
}

/// At density 1. Primitives are their own hulls.
MassProperties uniformMass(const BodyDraft& draft) {
  return std::visit(
      [&](const auto& shape) -> MassProperties {
        if constexpr (requires { massProperties(shape, 1); })
          return draft.massFrom == MassFrom::shell ? shellProperties(shape, draft.thickness) : massProperties(shape, 1);
        return {};
      },
      draft.body.shape);
}

void completePrimitive(BodyDraft& draft, const SceneDraft& scene, FaultList& faults) {
  if (draft.body.motion == Motion::fixed) return;
  if (std::holds_alternative<Plane>(draft.body.shape)) {
    addFault(faults, draft.field, "a plane is infinite and cannot move; give \"motion\": \"static\"");
    return;
  }
  if (draft.body.motion == Motion::driven) return;
  const double density = scene.scene.materials[static_cast<std::size_t>(draft.body.material)].density;
  draft.body.massProperties = completeMass(draft, uniformMass(draft), density, faults);
}

void addBody(const Body& body, SceneDraft& scene, const Field& name, FaultList& faults) {
  const int index = static_cast<int>(scene.scene.bodies.size());
  const auto [earlier, isNew] = scene.bodyIndex.emplace(body.name, index);
  if (!isNew) {
    const auto& first = scene.scene.bodies[static_cast<std::size_t>(earlier->second)];
    addFault(faults, name,
             fmt::format("duplicate name {}; names of bodies must differ; the first is {}", inQuotes(body.name),
                         first.where));
  }
  scene.scene.bodies.push_back(body);
  scene.draftOfBody.push_back(scene.bodies.size());
}

// Copy number N is named name_N.
void addCopies(const Copies& copies, const BodyDraft& draft, SceneDraft& scene, const Field& name, FaultList& faults) {
  Body body = draft.body;
  std::vector<Body>& bodies = scene.scene.bodies;
  const int count = static_cast<int>(copies.total());
  if (bodies.size() + static_cast<std::size_t>(count) > 2 * bodies.capacity())
    bodies.reserve(bodies.size() + static_cast<std::size_t>(count));
  for (int number = 0; number < count; ++number) {
    const RigidTransform move = copies.move(number);
    body.name = fmt::format("{}_{}", draft.body.name, number);
    body.worldFromBody = move * draft.body.worldFromBody;
    body.linearVelocity = move.rotation * draft.body.linearVelocity;
    body.angularVelocity = move.rotation * draft.body.angularVelocity;
    body.prescribed = draft.body.prescribed;
    if (body.prescribed) shift(*body.prescribed, move.translation);
    addBody(body, scene, name, faults);
  }
}

// Copies may be far from the first.
void checkPlaces(const Copies& copies, const BodyDraft& draft, const Field& field, FaultList& faults) {
  const RigidTransform last = copies.move(static_cast<int>(copies.total()) - 1);
  const Vec3 place = last * draft.body.worldFromBody.translation;
  for (const double coordinate : place) {
    if (kCoordinates.holds(coordinate)) continue;
    addFault(faults, field,
             fmt::format("the last copy is at {:g} m; allowed are {:g}..{:g} m; bring copies closer", coordinate,
                         kCoordinates.least, kCoordinates.most));
    return;
  }
}

/// Of a sphere inside the shape, which is convex; 0 where that is not known yet.
double innerRadiusOf(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const auto* box = std::get_if<Box>(&shape)) return box->size.minCoeff() / 2;
  if (const auto* cylinder = std::get_if<Cylinder>(&shape)) return std::min(cylinder->radius, cylinder->length / 2);
  if (const auto* capsule = std::get_if<Capsule>(&shape)) return capsule->radius;
  return 0;
}

/// How many pairs of copies are nearer to each other than `distance`, counted up to `most` and a row more.
double pairsNearer(double distance, const Copies& copies, double most) {
  CRADLE_CHECK(!copies.ring);
  const auto reach = [&](int axis) {
    const int count = copies.count[static_cast<std::size_t>(axis)];
    const double steps = copies.spacing[axis] == 0 ? count : distance / std::abs(copies.spacing[axis]);
    return static_cast<int>(std::min(steps, count - 1.0));
  };
  const std::array<int, 3> reaches = {reach(0), reach(1), reach(2)};
  double pairs = 0;  // each twice
  for (int x = -reaches[0]; x <= reaches[0] && pairs <= 2 * most; ++x)
    for (int y = -reaches[1]; y <= reaches[1] && pairs <= 2 * most; ++y)
      for (int z = -reaches[2]; z <= reaches[2]; ++z) {
        if ((x == 0 && y == 0 && z == 0) || copies.spacing.cwiseProduct(Vec3(x, y, z)).norm() >= distance) continue;
        pairs += double(copies.count[0] - std::abs(x)) * double(copies.count[1] - std::abs(y)) *
                 double(copies.count[2] - std::abs(z));
      }
  return pairs / 2;
}

/// The same of a ring through `place` (m), whose chords of k steps are 2 R sin(pi k / n), at least 4 R k / n: no fewer.
double pairsNearer(double distance, const Copies::Ring& ring, const Vec3& place) {
  const double radius = ring.axis.cross(place - ring.center).norm(), count = ring.count;
  return count * std::floor(radius > 0 ? std::min(count / 2, distance * count / (4 * radius)) : count / 2);
}

/// What a plan would refuse after it has made all bodies: a line of a scene can ask for a million at one place.
void requireApart(const Copies& copies, const BodyDraft& draft, const Field& field, const FaultList& faults) {
  if (draft.body.motion != Motion::dynamic || draft.body.collision == CollisionChoice::none) return;
  const double distance = 2 * innerRadiusOf(draft.body.shape), most = kMaxPairs + kMaxLinks;
  const double pairs = copies.ring ? pairsNearer(distance, *copies.ring, draft.body.worldFromBody.translation)
                                   : pairsNearer(distance, copies, most);
  if (pairs <= most) return;
  faults.throwIfAny();
  throw Error(
      ErrorKind::limit, faults.where(field.place(), field.pointer),
      fmt::format("more than {} pairs of the copies are in one another; allowed are {} pairs of bodies that are "
                  "near enough to touch: take fewer copies, or move them apart",
                  kMaxPairs, kMaxPairs));
}

void writeOutBodies(ObjectReader& reader, BodyDraft& draft, SceneDraft& scene) {
  FaultList& faults = reader.faults();
  const auto copiesField = reader.find("copies");
  const Copies copies = draft.copies = parseCopies(reader);
  const double total = static_cast<double>(scene.scene.bodies.size()) + copies.total();
  if (copies.ring && draft.body.prescribed)
    addFault(faults, *copiesField, "a driven body has no copies in a ring; give each its own motion");
  draft.firstBody = static_cast<int>(scene.scene.bodies.size());
  const auto name = reader.find("name");
  if (!name || draft.body.name.empty()) return;
  if (total > kMaxBodies) {
    addFault(faults, copiesField.value_or(draft.field),
             fmt::format("the scene would have {} bodies; at most {} are allowed", total, kMaxBodies));
  } else if (copies.areAsked) {
    checkPlaces(copies, draft, *copiesField, faults);
    requireApart(copies, draft, *copiesField, faults);
    addCopies(copies, draft, scene, *name, faults);
  } else {
    addBody(draft.body, scene, *name, faults);
  }
  draft.bodyCount = static_cast<int>(scene.scene.bodies.size()) - draft.firstBody;
}

void parseBody(const Field& field, SceneDraft& scene, FaultList& faults) {
  const std::size_t faultsBefore = faults.count();
  BodyDraft draft;
  draft.field = field;
  draft.body.where = faults.where(field.place(), field.pointer);
  draft.body.entry = static_cast<int>(scene.bodies.size());
  ObjectReader reader(field, faults);
  parseName(reader, draft);
  parseCategory(reader, draft);
  parseMaterialName(reader, scene, draft);
  parseShape(reader, draft);
  draft.body.motion = reader.choice<Motion>(
      "motion", {{"dynamic", Motion::dynamic}, {"static", Motion::fixed}, {"driven", Motion::driven}}, Motion::dynamic);
  parseGivenMass(reader, draft);
  parsePose(reader, draft);
  parseDriven(reader, draft);
  if (faults.count() == faultsBefore && !draft.meshField) completePrimitive(draft, scene, faults);
  warnOfUnused(reader, draft);
  writeOutBodies(reader, draft, scene);
  reader.rejectUnknownKeys();
  draft.isSound = faults.count() == faultsBefore;
  scene.bodies.push_back(std::move(draft));
}

}  // namespace

void parseBodies(ObjectReader& root, SceneDraft& draft) {
  root.require("bodies");
  for (const Field& item : root.items("bodies")) parseBody(item, draft, root.faults());
}

}  // namespace cradle
