#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `wishes`. Bodies and the duration must be there.
void parseWishes(ObjectReader& root, SceneDraft& draft);

}  // namespace cradle
