#pragma once

#include <string>

#include "commands/simulate_scene.h"

namespace cradle {

/// `cradle check SCENE`: loads the scene and its meshes and says what is in it; as JSON with its warnings, and where it
/// is not in order with what is wrong: faults of its text, or what keeps it from being simulated. Throws as loading
/// does.
void checkScene(const std::string& scenePath, const SceneOptions& options, bool asJson);

}  // namespace cradle
