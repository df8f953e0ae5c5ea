#pragma once

#include <optional>

#include "mesh/ray_cast.h"
#include "scene/scene.h"

namespace cradle {

/// Distance (m, >= 0) along a ray to a body's surface, both in the body's frame; nothing if it misses. A plane is not
/// there from behind. O(1); of a model O(triangles).
std::optional<double> castRay(const Ray& ray, const Body& body, const Scene& scene);

}  // namespace cradle
