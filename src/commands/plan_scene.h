#pragma once

#include <string>

#include "commands/simulate_scene.h"

namespace cradle {

/// `cradle plan SCENE`: prints what was chosen to simulate it, why, what is promised, and what was left out.
void printPlan(const std::string& scenePath, const SceneOptions& options, bool asJson);

}  // namespace cradle
