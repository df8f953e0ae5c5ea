#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `pushes`. Bodies must be there.
void parsePushes(ObjectReader& root, SceneDraft& draft);

}  // namespace cradle
