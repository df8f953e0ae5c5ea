#pragma once

#include <algorithm>

#include "scene/scene.h"

namespace cradle {

inline std::size_t countBodies(const Scene& scene, Motion motion) {
  return static_cast<std::size_t>(std::ranges::count(scene.bodies, motion, &Body::motion));
}

}  // namespace cradle
