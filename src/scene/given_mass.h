#pragma once

#include <optional>

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

/// `massFrom`, `thickness`, `mass`, `centerOfMass` and `inertiaTensor` as the scene file gives them.
void parseGivenMass(ObjectReader& reader, BodyDraft& draft);

/// Mass properties of a dynamic body: those given, the others of its shape. `ofShape` are the shape's at density 1,
/// unset if it has none; then mass and inertia must be given. What overflows or vanishes is a fault of `draft`.
MassProperties completeMass(const BodyDraft& draft, const std::optional<MassProperties>& ofShape, double density,
                            FaultList& faults);

}  // namespace cradle
