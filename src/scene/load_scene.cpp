#include "scene/load_scene.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>

#include "core/read_file.h"
#include "mesh/mesh_library.h"
#include "scene/attach_models.h"
#include "scene/attach_textures.h"
#include "scene/complete_links.h"
#include "scene/draws.h"
#include "scene/json_document.h"
#include "scene/parse_bodies.h"
#include "scene/parse_bumps.h"
#include "scene/parse_camera.h"
#include "scene/parse_captions.h"
#include "scene/parse_links.h"
#include "scene/parse_materials.h"
#include "scene/parse_pushes.h"
#include "scene/parse_settings.h"
#include "scene/parse_wishes.h"

namespace cradle {
namespace {

namespace fs = std::filesystem;

/// Files that a scene names: relative paths start from its folder.
class AssetFolder {
 public:
  /// Throws Error(usage) if `assetRoot` is no folder; empty: there is no limit.
  AssetFolder(const std::string& scenePath, const std::string& assetRoot) : folder_(fs::path(scenePath).parent_path()) {
    if (assetRoot.empty()) return;
    std::error_code failed;
    root_ = fs::canonical(assetRoot, failed);
    if (!fs::is_directory(root_, failed))
      throw Error(ErrorKind::usage, assetRoot, "is no folder; name one that the meshes are in");
  }

  /// Throws Error(mesh) if that is not below the root.
  std::string pathOf(const std::string& named) const {
    const std::string path = (folder_ / named).string();
    if (!root_.empty() && !isBelow(path, root_))
      throw Error(ErrorKind::mesh, path,
                  fmt::format("is not below {}, and no other files are allowed here", root_.string()));
    return path;
  }

 private:
  fs::path folder_, root_;
};

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
  parseCaptions(root, draft);
  parseBumps(root, draft);
  parseWishes(root, draft);
  root.text("$schema", "");  // for editors
  root.rejectUnknownKeys();
  completeLinks(draft, faults);
  return draft;
}

/// A scene with values to be drawn is many scenes.
void refuseDraws(const JsonValue& document, FaultList& faults) {
  const DrawPlace draw = firstDraw(document);
  if (draw.value == nullptr) return;
  checkDraws(document, faults);
  faults.add(draw.value->place, draw.pointer,
             "a value that is to be drawn, where one is needed; make scenes of this one with `cradle sample SCENE -n "
             "10 --seed 1 -o FOLDER`");
  faults.throwIfAny();
}

LoadedScene parsed(const JsonValue& document, const std::string& path, const ModelSource& models,
                   const TextureSource& textures, FaultList& textFaults) {
  FaultList meshFaults(path, ErrorKind::mesh);
  SceneDraft draft = parseText(document, textFaults);
  textFaults.throwIfAny();

  attachTextures(draft, textures, textFaults, meshFaults);
  attachModels(draft, models, textFaults, meshFaults);
  completeLinks(draft, textFaults);
  if (textFaults.count() + meshFaults.count() == 0) completePushes(draft, textFaults);
  textFaults.throwIfAny();
  meshFaults.throwIfAny();

  collectLinks(draft);
  draft.scene.path = path;
  return {std::move(draft.scene), textFaults.warnings()};
}

}  // namespace

std::string modelName(const MeshReference& reference) {
  constexpr std::array kUp = {"", "^x", "^y", "^z"};
  return fmt::format("{}#{}@{}{}{}{}", reference.path, reference.object, reference.scale,
                     kUp[static_cast<std::size_t>(reference.upAxis)], reference.fillsHoles ? "+filled" : "",
                     reference.isTextured ? "+textured" : "");
}

ModelSource modelFilesBeside(const std::string& scenePath, const std::string& assetRoot) {
  return [files = AssetFolder(scenePath, assetRoot),
          library = std::make_shared<MeshLibrary>()](const MeshReference& reference) {
    MeshReference onDisk = reference;
    onDisk.path = files.pathOf(reference.path);
    return library->load(onDisk);
  };
}

TextureSource textureFilesBeside(const std::string& scenePath, const std::string& assetRoot) {
  return [files = AssetFolder(scenePath, assetRoot)](const std::string& path) {
    Texture texture = *readTexture(files.pathOf(path));
    texture.name = path;
    return std::make_shared<const Texture>(std::move(texture));
  };
}

LoadedScene parseScene(const std::string& text, const std::string& path, const ModelSource& models,
                       const TextureSource& textures) {
  FaultList faults(path, ErrorKind::scene);
  const JsonValue document = readJson(text, faults);
  refuseDraws(document, faults);
  LoadedScene loaded = parsed(document, path, models, textures, faults);
  loaded.scene.text = text;
  return loaded;
}

LoadedScene parseScene(const JsonValue& document, const std::string& path, const ModelSource& models,
                       const TextureSource& textures) {
  FaultList faults(path, ErrorKind::scene);
  LoadedScene loaded = parsed(document, path, models, textures, faults);
  loaded.scene.text = writeJson(document);
  return loaded;
}

std::string readSceneText(const std::string& path) {
  std::string text = readFile(path, kLongestText, ErrorKind::scene);
  if (text.starts_with("SQLite format 3"))  // a trajectory holds a scene, but is none
    throw Error(ErrorKind::scene, path, "is a trajectory or another database, not a scene file (JSON)");
  return text;
}

LoadedScene loadScene(const std::string& path, const std::string& assetRoot) {
  return parseScene(readSceneText(path), path, modelFilesBeside(path, assetRoot), textureFilesBeside(path, assetRoot));
}

}  // namespace cradle
