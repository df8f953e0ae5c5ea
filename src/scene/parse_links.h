#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `springs`, `rods`, `ropes`, `ballJoints`, `hinges`, `sliders` and `welds`. Bodies must be there. Where the ends are,
/// and with it the lengths, is completed later.
void parseLinks(ObjectReader& root, SceneDraft& draft);

}  // namespace cradle
