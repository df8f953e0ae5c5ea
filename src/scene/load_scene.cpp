#include "scene/load_scene.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "scene/attach_models.h"
#include "scene/parse_bodies.h"
#include "scene/parse_camera.h"
#include "scene/parse_links.h"
#include "scene/parse_materials.h"
#include "scene/parse_pushes.h"
#include "scene/parse_settings.h"
#include "scene/settle_links.h"

namespace cradle {
namespace {

// One byte more than is allowed is read, so that the text is seen to be too long without reading a device for ever.
std::string readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text;
  char buffer[1 << 16];
  while (file && text.size() <= kLongestText) {
    file.read(buffer, sizeof buffer);
    text.append(buffer, static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof() && text.size() <= kLongestText) {
    throw Error(ErrorKind::scene, path, "cannot read this scene file; check the path and its permissions");
  }
  return text;
}

// All that the text alone says.
SceneDraft parseText(const JsonValue& document, FaultList& faults) {
  SceneDraft draft;
  ObjectReader root({&document, ""}, faults);
  parseSettings(root, draft.scene);
  parseMaterials(root, draft);
  parseBodies(root, draft);
  parseLinks(root, draft);
  parsePushes(root, draft);
  parseCamera(root, draft);
  root.rejectUnknownKeys();
  settleLinks(draft, faults);
  return draft;
}

}  // namespace

std::string modelName(const MeshReference& reference) {
  return fmt::format("{}#{}@{}", reference.path, reference.object, reference.scale);
}

ModelSource modelFilesBeside(const std::string& scenePath) {
  const auto folder = std::filesystem::path(scenePath).parent_path();
  return [folder](const MeshReference& reference) {
    return loadModel({(folder / reference.path).string(), reference.object, reference.scale});
  };
}

LoadedScene parseScene(const std::string& text, const std::string& path, const ModelSource& models) {
  FaultList textFaults(path), meshFaults(path);
  const JsonValue document = readJson(text, textFaults);
  SceneDraft draft = parseText(document, textFaults);
  textFaults.throwIfAny(ErrorKind::scene);

  attachModels(draft, models, textFaults, meshFaults);
  settleLinks(draft, textFaults);
  textFaults.throwIfAny(ErrorKind::scene);
  meshFaults.throwIfAny(ErrorKind::mesh);

  collectLinks(draft);
  draft.scene.path = path;
  draft.scene.text = text;
  return {std::move(draft.scene), std::move(draft.warnings)};
}

LoadedScene loadScene(const std::string& path) {
  return parseScene(readFile(path), path, modelFilesBeside(path));
}

}  // namespace cradle
