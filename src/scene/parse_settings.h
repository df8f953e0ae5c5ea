#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// All of the scene file that is about the scene as a whole: from `schema` to `output` and `lights`.
void parseSettings(ObjectReader& root, Scene& scene);

}  // namespace cradle
