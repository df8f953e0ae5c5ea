#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `materials` and `pairs`: fills materials (the first one is for bodies that name none) and surfacePairs.
void parseMaterials(ObjectReader& root, SceneDraft& draft);

}  // namespace cradle
