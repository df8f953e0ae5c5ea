#pragma once

#include "scene/load_scene.h"
#include "scene/scene_draft.h"

namespace cradle {

/// Loads the meshes that bodies name, each once, and completes those bodies: shape, mass properties, and whether the
/// mesh fits what the scene asks of it. Faults of the text go to `textFaults`, those of the meshes to `meshFaults`.
void attachModels(SceneDraft& draft, const ModelSource& models, FaultList& textFaults, FaultList& meshFaults);

}  // namespace cradle
