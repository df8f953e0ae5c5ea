#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `bumps`. Bodies must be there.
void parseBumps(ObjectReader& root, SceneDraft& draft);

}  // namespace cradle
