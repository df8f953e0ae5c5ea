#pragma once

#include "scene/scene.h"

namespace cradle {

/// Axes of a camera in the world: columns right, up, back (against the view), all unit and perpendicular. With `up` the
/// world's y, looking straight down has its -z up in the picture; straight up, its +z. A target at the position looks
/// along -z.
Mat3 cameraAxes(const Vec3& position, const Vec3& target, const Vec3& up = Vec3::UnitY());
Mat3 cameraAxes(const Camera& camera);

}  // namespace cradle
