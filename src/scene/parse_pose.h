#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `position`, `orientation` and the velocities of a body.
void parsePose(ObjectReader& reader, BodyDraft& draft);

}  // namespace cradle
