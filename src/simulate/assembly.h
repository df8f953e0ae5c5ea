#pragma once

#include <string>
#include <utility>
#include <vector>

#include "collision/collider.h"
#include "dynamics/equations_of_motion.h"
#include "dynamics/rope.h"
#include "scene/scene.h"

namespace cradle {

/// A scene turned into what the methods work on.
struct Assembly {
  Mechanism mechanism;
  ContactGeometry geometry;
  std::vector<RopeLimit> ropes;
  VectorX state;                                // at time 0
  std::vector<int> sceneBodies;                 // scene body of each moving body
  std::vector<int> movingBodies;                // moving body of each scene body, or kFixed
  std::vector<std::pair<int, int>> pairBodies;  // scene bodies A, B of each collider pair
  std::vector<std::pair<int, int>> ropeBodies;  // scene bodies A, B of each rope; kWorld
  std::vector<std::string> warnings;
};

/// The scene must have passed refuseUnsupported. Start velocities that violate rods are projected, with a warning.
Assembly assemble(const Scene& scene);

/// Throws Error(scene) that names everything in the scene that no method simulates yet, one a line.
void refuseUnsupported(const Scene& scene);

/// What the scene asks for and nothing uses yet.
std::vector<std::string> unusedRequests(const Scene& scene);

}  // namespace cradle
