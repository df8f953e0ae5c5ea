#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `camera`: where it is at the start, and how it moves. After the bodies, which it may name.
void parseCamera(ObjectReader& root, SceneDraft& draft);

}  // namespace cradle
