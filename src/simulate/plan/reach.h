#pragma once

#include <limits>
#include <vector>

#include "scene/scene.h"

namespace cradle {

/// A sphere that a body's centre of mass cannot leave.
struct Reach {
  Vec3 center = Vec3::Zero();  // m, world
  double radius = std::numeric_limits<double>::infinity();
};

/// Where each body can get to during the run, as far as that follows from its constraints to fixed points (lengths of
/// rods, ropes and joints), and, for bodies that touch nothing, from the energy that a body on springs has, or from the
/// parabola of a body that nothing holds. Infinite where nothing is known. `touches`: by body. O(bodies x links) at
/// worst.
std::vector<Reach> reachOf(const Scene& scene, const std::vector<char>& touches);

}  // namespace cradle
