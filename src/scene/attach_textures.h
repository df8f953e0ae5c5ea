#pragma once

#include "scene/load_scene.h"
#include "scene/scene_draft.h"

namespace cradle {

/// Loads the pictures that materials name as textures, each once, and notes which meshes need texture coordinates for
/// them. Faults of the text go to `textFaults`, those of the pictures to `meshFaults`.
void attachTextures(SceneDraft& draft, const TextureSource& textures, FaultList& textFaults, FaultList& meshFaults);

}  // namespace cradle
