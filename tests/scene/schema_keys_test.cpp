// Whether scene.schema.json names the very keys that the program knows. The program's are read off its own message
// about an unknown key, put into each object of a scene that has all keys in turn.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "scene/scene_texts.h"

namespace cradle {
namespace {

using Json = nlohmann::json;
using Keys = std::set<std::string>;

const char* const kUnknownKey = "unheardOf";
const char* const kDraw = "#/$defs/draw";  // any value may be one

class SchemaKeys : public testing::Test {
 protected:
  /// The parts of a node that describe the same value: itself, what it refers to, its alternatives but for a draw.
  std::vector<const Json*> partsOf(const Json& node) const;
  Keys keysOf(const Json& node) const;
  std::vector<const Json*> childrenOf(const Json& node, const std::string& key) const;
  void compareAll(const Json& value, const Json::json_pointer& place, const std::vector<const Json*>& nodes);
  void compare(const Json::json_pointer& place, const std::vector<const Json*>& nodes);

  Json schema_ = Json::parse(std::ifstream(CRADLE_SOURCE_DIR "/src/scene/scene.schema.json"));
  Json scene_ = Json::parse(everyKey());
  int compared_ = 0;
};

std::vector<const Json*> SchemaKeys::partsOf(const Json& node) const {
  if (node.value("$ref", "") == kDraw) return {};
  std::vector<const Json*> parts{&node};
  const auto add = [&](const Json& part) {
    const auto more = partsOf(part);
    parts.insert(parts.end(), more.begin(), more.end());
  };
  if (node.contains("$ref")) add(schema_.at(Json::json_pointer(node["$ref"].get<std::string>().substr(1))));
  for (const char* key : {"oneOf", "allOf", "anyOf"}) {
    if (node.contains(key)) {
      for (const Json& part : node[key]) add(part);
    }
  }
  return parts;
}

Keys SchemaKeys::keysOf(const Json& node) const {
  Keys keys;
  for (const Json* part : partsOf(node)) {
    if (!part->contains("properties")) continue;
    for (const auto& [key, unused] : (*part)["properties"].items()) keys.insert(key);
  }
  return keys;
}

std::vector<const Json*> SchemaKeys::childrenOf(const Json& node, const std::string& key) const {
  std::vector<const Json*> children;
  for (const Json* part : partsOf(node)) {
    if (part->contains("properties") && (*part)["properties"].contains(key)) {
      children.push_back(&(*part)["properties"][key]);
    } else if (part->contains("additionalProperties") && (*part)["additionalProperties"].is_object()) {
      children.push_back(&(*part)["additionalProperties"]);
    }
  }
  return children;
}

// "...; allowed are a, b, c" up to the end or the next semicolon.
Keys keysInMessage(const std::string& message) {
  const auto start = message.find("allowed are ");
  if (start == message.npos) return {};
  std::istringstream list(message.substr(start + 12, message.find(';', start) - start - 12));
  Keys keys;
  for (std::string key; std::getline(list >> std::ws, key, ',');) keys.insert(key);
  return keys;
}

void SchemaKeys::compare(const Json::json_pointer& place, const std::vector<const Json*>& nodes) {
  Keys expected;
  for (const Json* node : nodes) expected.merge(keysOf(*node));
  Json changed = scene_;
  changed[place][kUnknownKey] = 0;
  EXPECT_EQ(keysInMessage(errorOf(changed.dump()).what()), expected) << place;
  ++compared_;
}

void SchemaKeys::compareAll(const Json& value, const Json::json_pointer& place, const std::vector<const Json*>& nodes) {
  const bool isObjectWithNamesOfItsOwn = place == Json::json_pointer("/materials");
  if (value.is_object() && !isObjectWithNamesOfItsOwn) compare(place, nodes);
  for (const auto& [key, child] : value.items()) {
    if (!child.is_structured()) continue;
    std::vector<const Json*> children;
    for (const Json* node : nodes) {
      for (const Json* part : partsOf(*node)) {
        if (value.is_array() && part->contains("items")) children.push_back(&(*part)["items"]);
      }
      const auto named = value.is_object() ? childrenOf(*node, key) : std::vector<const Json*>{};
      children.insert(children.end(), named.begin(), named.end());
    }
    compareAll(child, value.is_array() ? place / std::stoul(key) : place / key, children);
  }
}

TEST_F(SchemaKeys, AreThoseOfTheProgramInEveryObject) {
  compareAll(scene_, Json::json_pointer(), {&schema_});
  EXPECT_GT(compared_, 30);
}

void collectKeys(const Json& value, Keys& keys) {
  for (const auto& [key, child] : value.items()) {
    if (value.is_object()) keys.insert(key);
    if (child.is_structured()) collectKeys(child, keys);
  }
}

TEST_F(SchemaKeys, AllStandInTheSceneWithEveryKey) {
  Keys used, named;
  collectKeys(scene_, used);
  const auto collect = [&](const Json& node) { named.merge(keysOf(node)); };
  collect(schema_);
  for (const auto& [name, node] : schema_["$defs"].items())
    if (name != "draw") collect(node);
  for (const std::string& key : named) EXPECT_TRUE(used.contains(key)) << key;
}

}  // namespace
}  // namespace cradle
