#include "commands/check_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "commands/body_list.h"
#include "commands/warnings.h"
#include "core/console.h"
#include "core/error.h"
#include "core/json_numbers.h"
#include "core/printable.h"
#include "scene/count_bodies.h"
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

/// The key of a kind of links, as scenes have it: "ballJoints" of "ball joint".
std::string keyOf(const std::string& noun) {
  std::string key;
  for (std::size_t i = 0; i < noun.size(); ++i)
    if (noun[i] != ' ') key += i > 0 && noun[i - 1] == ' ' ? static_cast<char>(noun[i] - 'a' + 'A') : noun[i];
  return key + 's';
}

Json jsonOf(const Scene& scene) {
  Json links = Json::object(), bodies = Json::array();
  forEachKindOfLink(scene, [&](const auto& ofKind) {
    if (!ofKind.empty()) links[keyOf(LinkOf<decltype(ofKind)>::kNoun)] = ofKind.size();
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

/// A line of an error, with the place that it begins with: "FILE:LINE:COLUMN /pointer: what".
Json faultOf(const std::string& path, const std::string& line) {
  const std::string file = printableLine(path) + ':';
  std::uint32_t row = 0, column = 0;
  const char *end = line.data() + line.size(), *at = line.data() + std::min(file.size(), line.size());
  const auto toColumn = std::from_chars(at, end, row);
  if (!line.starts_with(file) || toColumn.ec != std::errc() || toColumn.ptr == end || *toColumn.ptr != ':')
    return {{"message", line}};
  const auto toRest = std::from_chars(toColumn.ptr + 1, end, column);
  const std::string rest(toRest.ptr, end);  // " /pointer: what", or ": what"
  const std::size_t what = rest.find(": ");
  if (toRest.ec != std::errc() || what == std::string::npos) return {{"message", line}};
  return {{"line", row},
          {"column", column},
          {"pointer", what > 0 ? rest.substr(1, what - 1) : ""},
          {"message", rest.substr(what + 2)}};
}

Json faultsOf(const std::string& path, const Error& error) {
  Json faults = Json::array();
  std::istringstream lines(error.what());
  for (std::string line; std::getline(lines, line);) faults.push_back(faultOf(path, line));
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
    if (error.kind() == ErrorKind::interrupted) throw;
    printJson(path, warnings, false, {{"faults", faultsOf(path, error)}});
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
