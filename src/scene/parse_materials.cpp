#include "scene/parse_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace cradle {
namespace {

constexpr std::size_t kMaxMaterials = 4000;  // their pairs are a table: 4000 take 400 MB

// A body that slides would be held back more than one that rests.
void checkFrictions(double staticFriction, double dynamicFriction, const Field& field, FaultList& faults) {
  if (staticFriction >= dynamicFriction) return;
  addFault(faults, field,
           fmt::format("staticFriction is {} and dynamicFriction {}; static must not be below dynamic", staticFriction,
                       dynamicFriction));
}

void parsePattern(ObjectReader& reader, Material& material) {
  material.pattern = reader.choice<Pattern>("pattern",
                                            {{"none", Pattern::none},
                                             {"stripes", Pattern::stripes},
                                             {"checks", Pattern::checks},
                                             {"beachBall", Pattern::beachBall}},
                                            material.pattern);
  const auto color = reader.find("patternColor");
  if (color) material.patternColor = readColor(*color, reader.faults()).value_or(material.patternColor);
  if (color && material.pattern == Pattern::none)
    addFault(reader.faults(), *color,
             "patternColor is the second colour of a pattern; give the material one, or leave it out");
}

/// Of the material that will be number `material`.
void parseTexture(ObjectReader& reader, const Material& described, int material, SceneDraft& draft) {
  const auto field = reader.find("texture");
  const auto path = field ? readText(*field, reader.faults()) : std::nullopt;
  if (!path) return;
  if (path->empty()) addFault(reader.faults(), *field, "the path of the texture is empty; name a PNG or JPEG file");
  if (described.pattern != Pattern::none)
    addFault(reader.faults(), *field, "a material has a texture or a pattern, not both; leave one out");
  draft.textures.emplace(material, TextureDraft{*field, *path});
}

Material parseMaterial(const Field& field, const std::string& name, SceneDraft& draft, FaultList& faults) {
  const std::size_t faultsBefore = faults.count();
  Material material;
  material.name = name;
  ObjectReader reader(field, faults);
  material.density = reader.number("density", kDensities, "kg/m^3", material.density);
  material.restitution = reader.number("restitution", kFraction, "", material.restitution);
  const bool hasStatic = reader.find("staticFriction").has_value();
  const bool hasDynamic = reader.find("dynamicFriction").has_value();
  material.staticFriction = reader.number("staticFriction", kFrictions, "", material.staticFriction);
  material.dynamicFriction = reader.number("dynamicFriction", kFrictions, "", material.dynamicFriction);
  // One alone below, or above, what the other is by default moves that with it.
  if (!hasDynamic) material.dynamicFriction = std::min(material.dynamicFriction, material.staticFriction);
  if (!hasStatic) material.staticFriction = std::max(material.staticFriction, material.dynamicFriction);
  material.baseColor = reader.color("baseColor");
  material.metallic = reader.number("metallic", kFraction, "", material.metallic);
  material.roughness = reader.number("roughness", kFraction, "", material.roughness);
  parsePattern(reader, material);
  parseTexture(reader, material, static_cast<int>(draft.scene.materials.size()), draft);
  reader.rejectUnknownKeys();
  if (faults.count() == faultsBefore) {
    checkFrictions(material.staticFriction, material.dynamicFriction, field, faults);
  }
  return material;
}

SurfacePair usualPair(const Material& a, const Material& b) {
  return {std::min(a.restitution, b.restitution), std::sqrt(a.staticFriction * b.staticFriction),
          std::sqrt(a.dynamicFriction * b.dynamicFriction)};
}

void fillUsualPairs(Scene& scene) {
  const std::size_t count = scene.materials.size();
  scene.surfacePairs.assign(count, std::vector<SurfacePair>(count));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      // The same order of factors both ways: symmetric to the last bit.
      scene.surfacePairs[i][j] = usualPair(scene.materials[std::min(i, j)], scene.materials[std::max(i, j)]);
    }
  }
}

using IndexPair = std::pair<std::size_t, std::size_t>;

// The materials that a pair names, the smaller index first.
std::optional<IndexPair> parseMaterialNames(ObjectReader& reader, const SceneDraft& draft) {
  const auto field = reader.require("materials");
  if (!field) return std::nullopt;
  std::vector<std::size_t> indices;
  for (const Field& item : readItems(*field, 2, reader.faults())) {
    if (const auto index = findNamed(item, draft.materialIndex, "material", reader.faults())) {
      indices.push_back(static_cast<std::size_t>(*index));
    }
  }
  if (indices.size() != 2) return std::nullopt;
  return IndexPair{std::min(indices[0], indices[1]), std::max(indices[0], indices[1])};
}

void parsePair(const Field& field, SceneDraft& draft, std::set<IndexPair>& named, FaultList& faults) {
  const std::size_t faultsBefore = faults.count();
  ObjectReader reader(field, faults);
  const auto indices = parseMaterialNames(reader, draft);
  SurfacePair pair;
  if (indices) pair = draft.scene.surfacePairs[indices->first][indices->second];
  pair.restitution = reader.number("restitution", kFraction, "", pair.restitution);
  pair.staticFriction = reader.number("staticFriction", kFrictions, "", pair.staticFriction);
  pair.dynamicFriction = reader.number("dynamicFriction", kFrictions, "", pair.dynamicFriction);
  reader.rejectUnknownKeys();
  if (!indices || faults.count() != faultsBefore) return;
  checkFrictions(pair.staticFriction, pair.dynamicFriction, field, faults);
  if (!named.insert(*indices).second) {
    addFault(faults, field, "these two materials were paired before; each pair may stand once");
  }
  draft.scene.surfacePairs[indices->first][indices->second] = pair;
  draft.scene.surfacePairs[indices->second][indices->first] = pair;
}

void parseNamedMaterials(const Field& field, SceneDraft& draft, FaultList& faults) {
  ObjectReader(field, faults);  // reports anything but an object
  const auto* members = std::get_if<JsonValue::Object>(&field.value->content);
  if (members == nullptr) return;
  if (members->size() > kMaxMaterials) {
    addFault(faults, field, fmt::format("{} materials; at most {} are allowed", members->size(), kMaxMaterials));
    return;
  }
  for (const JsonMember& member : *members) {
    const Field item{&member.value, pointerTo(field.pointer, member.key)};
    if (member.key.empty()) addFault(faults, item, "the name of the material is empty; it needs one");
    checkName(item, member.key, faults);
    draft.materialIndex.emplace(member.key, static_cast<int>(draft.scene.materials.size()));
    draft.scene.materials.push_back(parseMaterial(item, member.key, draft, faults));
  }
}

}  // namespace

void parseMaterials(ObjectReader& root, SceneDraft& draft) {
  draft.scene.materials = {Material{}};
  if (const auto field = root.find("materials")) parseNamedMaterials(*field, draft, root.faults());
  fillUsualPairs(draft.scene);
  std::set<IndexPair> named;
  for (const Field& item : root.items("pairs")) parsePair(item, draft, named, root.faults());
}

}  // namespace cradle
