#pragma once

#include "scene/scene.h"

namespace cradle {

/// Whether a point (m, in the body's frame) lies inside a body's surface. Nothing is inside a plane, which is not there
/// from behind, nor inside a model that is no solid. O(1); of a model O(triangles log triangles).
bool isInside(const Scene& scene, const Body& body, const Vec3& point);

}  // namespace cradle
