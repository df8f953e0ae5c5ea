#pragma once

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `pushes`. Bodies must be there.
void parsePushes(ObjectReader& root, SceneDraft& draft);

/// Finds the bodies and points of pushes that are given by what a pixel shows, or by a ray without a body, at the start
/// of the scene. Models must be there.
void completePushes(SceneDraft& draft, FaultList& faults);

}  // namespace cradle
