#pragma once

#include <numbers>

#include "scene/read_fields.h"
#include "scene/scene_draft.h"

namespace cradle {

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180;

/// `position`, `orientation` and the velocities of a body.
void parsePose(ObjectReader& reader, BodyDraft& draft);

/// `position` and `orientation` of an object, each `usual` where it is not given.
RigidTransform parsePlace(ObjectReader& reader, const RigidTransform& usual);

}  // namespace cradle
