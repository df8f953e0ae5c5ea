#pragma once

#include "math/types.h"
#include "scene/camera_axes.h"
#include "scene/scene.h"

namespace cradle {

/// The projection of a picture of `width` x `height` pixels, infinitely deep, points relative to `origin` (m, world):
/// near numbers keep single precision exact enough. `nearPlane` in m, > 0.
Eigen::Matrix4f clipFromWorld(const Camera& camera, const Vec3& origin, int width, int height, double nearPlane);

/// Pixel coordinates of a world point in front of the camera: x to the right, y down, (0, 0) the picture's top left
/// corner, so that the first pixel's centre is at (0.5, 0.5).
Eigen::Vector2d projectToPixel(const Camera& camera, const Vec3& point, int width, int height);

}  // namespace cradle
