#pragma once

#include <functional>
#include <string>

#include "scene/scene.h"

namespace cradle {

/// Where the models of a scene come from: files, or a trajectory that holds them already.
using ModelSource = std::function<LoadedModel(const MeshReference&)>;

/// A scene, and what the user should know about it that is no error.
struct LoadedScene {
  Scene scene;
  std::vector<std::string> warnings;  // "FILE:LINE:COLUMN /json/pointer: ..."
};

/// Reads a scene file and the meshes that it names. Throws Error(scene) with every fault of the text (at most 50, one a
/// line: "FILE:LINE:COLUMN /json/pointer: what was found; what is allowed; hint"), else Error(mesh) with every mesh
/// that cannot be used.
LoadedScene loadScene(const std::string& path);

/// The same for a text that is already in memory. `path` is used in messages and to resolve relative mesh paths.
LoadedScene parseScene(const std::string& text, const std::string& path, const ModelSource& models);

}  // namespace cradle
