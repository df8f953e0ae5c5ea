#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `bodies`: one draft for each entry, and the bodies with their copies written out. Those with meshes still lack shape
/// and mass properties. Materials must be there.
void parseBodies(ObjectReader& root, SceneDraft& draft);

}  // namespace cradle
