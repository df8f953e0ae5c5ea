#pragma once

#include <functional>
#include <string>

#include "scene/json_document.h"
#include "scene/scene.h"

namespace cradle {

/// Where the models of a scene come from: files, or a trajectory that holds them already. The path of the reference is
/// the scene file's own, not yet resolved. Throws Error(mesh) if there is no such model.
using ModelSource = std::function<LoadedModel(const MeshReference&)>;

/// Where the textures of its materials come from, likewise. Throws Error(mesh) if there is no such picture.
using TextureSource = std::function<SharedTexture(const std::string& path)>;

/// Name of the model in Scene::models and in trajectories: "path#object@scale", the path as the scene file has it,
/// "^z" behind that with an axis that the scene names, "+filled" where holes may be filled, and "+textured" with the
/// texture of a material.
std::string modelName(const MeshReference& reference);

/// Reads models from files; relative paths start from the folder of the scene file. Files must be below `assetRoot`,
/// through all links, unless that is empty. Throws Error(usage) if it is no folder.
ModelSource modelFilesBeside(const std::string& scenePath, const std::string& assetRoot = "");

/// Reads textures from files in the same way.
TextureSource textureFilesBeside(const std::string& scenePath, const std::string& assetRoot = "");

/// A scene, and what the user should know about it that is no error.
struct LoadedScene {
  Scene scene;
  std::vector<std::string> warnings;  // "FILE:LINE:COLUMN /json/pointer: ..."
};

/// The text of a scene file. Throws Error(scene) if it cannot be read, or is none.
std::string readSceneText(const std::string& path);

/// Reads a scene file and the meshes that it names. Throws Error(scene) with every fault of the text (at most 50, one a
/// line: "FILE:LINE:COLUMN /json/pointer: what was found; what is allowed; hint"), else Error(mesh) with every mesh
/// that cannot be used. Meshes are looked at only if the text has no faults; the faults of the text that only they can
/// show (a vertex that is not there) are then thrown first. `assetRoot` is that of modelFilesBeside.
LoadedScene loadScene(const std::string& path, const std::string& assetRoot = "");

/// The same for a text that is already in memory; `path` is for messages.
LoadedScene parseScene(const std::string& text, const std::string& path, const ModelSource& models,
                       const TextureSource& textures = readTexture);

/// The same for a tree in which draws were made; its places are those of the text with the draws.
LoadedScene parseScene(const JsonValue& document, const std::string& path, const ModelSource& models,
                       const TextureSource& textures);

}  // namespace cradle
