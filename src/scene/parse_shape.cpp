#include "scene/parse_shape.h"

#include <fmt/format.h>

#include <array>

namespace cradle {
namespace {

constexpr std::array kShapeKeys{"mesh", "sphere", "box", "cylinder", "capsule", "plane"};

Sphere parseSphere(const Field& field, FaultList& faults) {
  ObjectReader reader(field, faults);
  Sphere sphere;
  sphere.radius = reader.number("radius", kLengths, "m", sphere.radius);
  reader.rejectUnknownKeys();
  return sphere;
}

Box parseBox(const Field& field, FaultList& faults) {
  ObjectReader reader(field, faults);
  Box box;
  if (const auto size = reader.find("size")) {
    const std::vector<Field> items = readItems(*size, 3, faults);
    for (std::size_t i = 0; i < items.size(); ++i) {
      box.size[static_cast<Eigen::Index>(i)] = readNumber(items[i], kLengths, "m", faults).value_or(1);
    }
  }
  reader.rejectUnknownKeys();
  return box;
}

template <typename RoundShape>
RoundShape parseRoundShape(const Field& field, FaultList& faults) {
  ObjectReader reader(field, faults);
  RoundShape shape;
  shape.radius = reader.number("radius", kLengths, "m", shape.radius);
  shape.length = reader.number("length", kLengths, "m", shape.length);
  reader.rejectUnknownKeys();
  return shape;
}

Plane parsePlane(const Field& field, FaultList& faults) {
  ObjectReader reader(field, faults);
  Plane plane;
  plane.normal = reader.direction("normal", plane.normal);
  reader.rejectUnknownKeys();
  return plane;
}

void setPrimitive(const Shape& shape, double size, BodyDraft& draft) {
  draft.body.shape = shape;
  draft.size = size;
}

void parsePrimitive(const std::string& key, const Field& field, BodyDraft& draft, FaultList& faults) {
  if (key == "sphere") {
    const Sphere sphere = parseSphere(field, faults);
    setPrimitive(sphere, sphere.radius, draft);
  } else if (key == "box") {
    const Box box = parseBox(field, faults);
    setPrimitive(box, box.size.stableNorm() / 2, draft);
  } else if (key == "cylinder") {
    const auto cylinder = parseRoundShape<Cylinder>(field, faults);
    setPrimitive(cylinder, Eigen::Vector2d(cylinder.radius, cylinder.length / 2).stableNorm(), draft);
  } else if (key == "capsule") {
    const auto capsule = parseRoundShape<Capsule>(field, faults);
    setPrimitive(capsule, capsule.radius + capsule.length / 2, draft);
  } else {
    setPrimitive(parsePlane(field, faults), 0, draft);  // its extent is no measure of anything
  }
}

void readMeshPath(const Field& field, BodyDraft& draft, FaultList& faults) {
  const auto path = readText(field, faults);
  if (path && path->empty()) addFault(faults, field, "mesh is empty; allowed is the path of a mesh file");
  draft.mesh.path = path.value_or("");
  draft.meshField = field;
}

// Exactly one of the keys says what the shape is.
void readShapeKeys(ObjectReader& reader, BodyDraft& draft) {
  FaultList& faults = reader.faults();
  std::vector<std::pair<std::string, Field>> found;
  for (const char* key : kShapeKeys) {
    if (const auto field = reader.find(key)) found.emplace_back(key, *field);
  }
  if (found.size() > 1) {
    addFault(faults, found[1].second,
             fmt::format("the shape is both {} and {}; it must be one of them", found[0].first, found[1].first));
  }
  if (found.empty()) {
    reader.addMissing({kShapeKeys.begin(), kShapeKeys.end()},
                      fmt::format("the shape says nothing; it must be one of {}", fmt::join(kShapeKeys, ", ")));
  } else if (found[0].first == "mesh") {
    readMeshPath(found[0].second, draft, faults);
  } else {
    parsePrimitive(found[0].first, found[0].second, draft, faults);
  }
}

void readShape(const Field& field, BodyDraft& draft, FaultList& faults) {
  const std::size_t faultsBefore = faults.count();
  ObjectReader reader(field, faults);
  if (!std::holds_alternative<JsonValue::Object>(field.value->content)) return;
  readShapeKeys(reader, draft);
  draft.mesh.object = reader.text("object", "");
  const double metres =
      reader.choice<double>("units", {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}, 1);
  draft.mesh.scale = reader.number("scale", kScales, "", 1) * metres;
  draft.givesUnits = reader.find("units") || reader.find("scale");
  draft.mesh.upAxis =
      reader.choice<UpAxis>("upAxis", {{"x", UpAxis::x}, {"y", UpAxis::y}, {"z", UpAxis::z}}, draft.mesh.upAxis);
  for (const char* key : {"object", "scale", "units", "upAxis"}) {
    const auto given = reader.find(key);
    if (given && !draft.meshField) addFault(faults, *given, fmt::format("{} goes with mesh only; remove it", key));
  }
  reader.rejectUnknownKeys();
  if (faults.count() != faultsBefore) draft.size.reset();
}

// What a primitive is, it also is for collision.
void checkCollisionChoice(const BodyDraft& draft, FaultList& faults) {
  const CollisionChoice choice = draft.body.collision;
  if (draft.meshField || choice == CollisionChoice::automatic || choice == CollisionChoice::none) return;
  const Shape& shape = draft.body.shape;
  if (choice == CollisionChoice::sphere && std::holds_alternative<Sphere>(shape)) return;
  if (choice == CollisionChoice::box && std::holds_alternative<Box>(shape)) return;
  addFault(
      faults, *draft.collision,
      "a shape given by numbers collides as itself; allowed are \"auto\", \"none\", and \"sphere\" for a sphere or "
      "\"box\" for a box");
}

}  // namespace

void parseShape(ObjectReader& reader, BodyDraft& draft) {
  FaultList& faults = reader.faults();
  const std::size_t faultsBefore = faults.count();
  if (const auto field = reader.require("shape")) readShape(*field, draft, faults);
  draft.collision = reader.find("collision");
  draft.body.collision = reader.choice<CollisionChoice>("collision",
                                                        {{"auto", CollisionChoice::automatic},
                                                         {"sphere", CollisionChoice::sphere},
                                                         {"box", CollisionChoice::box},
                                                         {"hull", CollisionChoice::hull},
                                                         {"mesh", CollisionChoice::mesh},
                                                         {"none", CollisionChoice::none}},
                                                        draft.body.collision);
  if (faults.count() == faultsBefore) checkCollisionChoice(draft, faults);
}

}  // namespace cradle
