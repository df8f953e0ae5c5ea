#pragma once

#include <numbers>

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180;

/// `position`, `orientation` and the velocities of a body.
void parsePose(ObjectReader& reader, BodyDraft& draft);

}  // namespace cradle
