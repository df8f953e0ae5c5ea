#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `shape` and `collision` of a body: a primitive is complete afterwards, a mesh is only named.
void parseShape(ObjectReader& reader, BodyDraft& draft);

}  // namespace cradle
