#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `captions` and `titleCard`. Bodies must be there.
void parseCaptions(ObjectReader& root, SceneDraft& draft);

}  // namespace cradle
