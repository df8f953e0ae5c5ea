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

/// The reach of each body during the run. It follows from lengths of rods, ropes and joints that lead to fixed points,
/// and for bodies that touch nothing from the energy of a body on springs, or from the parabola of a free body.
/// Infinite where nothing is known. `touches`: whether a body may touch another, by body. O(bodies + links log links).
std::vector<Reach> reachOf(const Scene& scene, const std::vector<char>& touches);

}  // namespace cradle
