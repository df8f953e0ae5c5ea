#pragma once

#include "scene/fault_list.h"
#include "scene/scene_draft.h"

namespace cradle {

/// Where the ends of each link are at the start: fills lengths that were left out, and finds the faults in those that
/// were given. Links of bodies whose shape is not there yet are left for the next call.
void completeLinks(SceneDraft& draft, FaultList& faults);

/// Moves the links, all complete, to the scene.
void collectLinks(SceneDraft& draft);

}  // namespace cradle
