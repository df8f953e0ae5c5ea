#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// How a driven body moves: `keyFrames` and `repeat`, `oscillation`, or the velocities that parsePose has read. Sets
/// its pose and velocities at time 0. A fault if a body that is not driven has these keys.
void parseDriven(ObjectReader& reader, BodyDraft& draft);

}  // namespace cradle
