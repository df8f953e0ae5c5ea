#include "commands/check_scene.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "commands/body_list.h"
#include "commands/warnings.h"
#include "core/console.h"
#include "core/error.h"
#include "core/printable.h"
#include "scene/count_bodies.h"
#include "scene/fault_list.h"
#include "simulate/assembly.h"
#include "simulate/start_overlaps.h"
#include "simulate/world.h"

namespace cradle {
namespace {

using Json = nlohmann::ordered_json;

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// ", 10 rods, 1 push": what there is of each kind.
std::string linksOf(const Scene& scene) {
  std::string text;
  const auto add = [&](std::size_t count, const std::string& one, const std::string& many) {
    if (count > 0) text += ", " + counted(count, one, many);
  };
  forEachKindOfLink(scene, [&](const auto& links) {
    const std::string noun = LinkOf<decltype(links)>::kNoun;
    add(links.size(), noun, noun + "s");
  });
  add(scene.pushes.size(), "push", "pushes");
  return text;
}

Scene loadWhole(const std::string& path, const SceneOptions& options) {
  Scene scene = loadSceneAndWarn(path, options);
  refuseUnsupported(scene);
  std::vector<Assembly> islands;
  // Bodies alone have nothing to be checked, and may be a million.
  for (const IslandPlan& island : planOf(scene).islands)
    if (!island.touching.empty() || !island.links.empty()) islands.push_back(assemble(scene, island));
  correctStartPenetrations(scene, islands);
  std::vector<std::string> warnings;
  for (const Assembly& assembly : islands)
    warnings.insert(warnings.end(), assembly.warnings.begin(), assembly.warnings.end());
  warnOfAll(warnings);
  return scene;
}

void print(const Scene& scene, const std::string& path) {
  const std::size_t driven = countBodies(scene, Motion::driven);
  show("{}: \"{}\" is in order: {} ({} dynamic{}){}; {} s, {} frames\n", printableLine(path), printableLine(scene.name),
       counted(scene.bodies.size(), "body", "bodies"), countBodies(scene, Motion::dynamic),
       driven > 0 ? fmt::format(", {} driven", driven) : "", linksOf(scene), scene.duration, lastFrame(scene) + 1);
  for (const std::string& line : describeBodies(scene)) show("  {}\n", line);
}

template <class Vector>
Json numbersOf(const Vector& vector) {
  Json numbers = Json::array();
  for (const double number : vector) numbers.push_back(number);
  return numbers;
}

Json jsonOf(const Body& body, const ShapeFacts& shape) {
  Json json = {{"name", body.name}, {"motion", nameOf(body.motion)}, {"shape", shape.kind}};
  json["size"] = shape.size ? numbersOf(*shape.size) : Json(nullptr);
  if (body.motion != Motion::dynamic) return json;
  const MassProperties& properties = body.massProperties;
  json["mass"] = properties.mass;
  json["centerOfMass"] = numbersOf(properties.centerOfMass);
  json["inertiaTensor"] = Json::array();
  for (const auto& row : properties.inertiaTensor.rowwise()) json["inertiaTensor"].push_back(numbersOf(row));
  return json;
}

Json jsonOf(const Scene& scene) {
  Json links = Json::object(), bodies = Json::array();
  forEachKindOfLink(scene, [&](const auto& ofKind) {
    if (!ofKind.empty()) links[std::string(LinkOf<decltype(ofKind)>::kNoun) + "s"] = ofKind.size();
  });
  const std::vector<ShapeFacts> shapes = shapesOf(scene);
  for (std::size_t i = 0; i < shapes.size(); ++i) bodies.push_back(jsonOf(scene.bodies[i], shapes[i]));
  return {{"name", scene.name},
          {"duration", scene.duration},
          {"frames", lastFrame(scene) + 1},
          {"pushes", scene.pushes.size()},
          {"links", links},
          {"bodies", bodies}};
}

/// Those of a text each with its place.
Json faultsOf(const Error& error) {
  const auto* ofText = dynamic_cast<const TextError*>(&error);
  if (!ofText) return Json::array({{{"message", error.what()}}});
  Json faults = Json::array();
  for (const TextFault& fault : ofText->faults())
    faults.push_back({{"line", fault.place.line},
                      {"column", fault.place.column},
                      {"pointer", fault.pointer},
                      {"message", fault.what}});
  return faults;
}

void printJson(const std::string& path, const CollectedWarnings& warnings, bool isInOrder, const Json& rest) {
  Json json = {{"scene", path}, {"inOrder", isInOrder}, {"warnings", warnings.texts()}};
  json.update(rest);
  show("{}\n", json.dump(2, ' ', true, Json::error_handler_t::replace));
}

void checkAsJson(const std::string& path, const SceneOptions& options) {
  const CollectedWarnings warnings;
  try {
    const Scene scene = loadWhole(path, options);
    printJson(path, warnings, true, jsonOf(scene));
  } catch (const Error& error) {
    printJson(path, warnings, false, {{"faults", faultsOf(error)}});
    throw;
  }
}

}  // namespace

void checkScene(const std::string& scenePath, const SceneOptions& options, bool asJson) {
  if (asJson)
    checkAsJson(scenePath, options);
  else
    print(loadWhole(scenePath, options), scenePath);
}

}  // namespace cradle
