#pragma once

#include <vector>

#include "scene/scene.h"
#include "trajectory/trajectory.h"

namespace cradle {

/// Where every body's frame is in a frame of the film: dynamic bodies from their states, others from the scene.
std::vector<RigidTransform> placeBodies(const Scene& scene, const Frame& frame);

/// The same at the start of the scene.
std::vector<RigidTransform> placeBodiesAtStart(const Scene& scene);

/// Box around a body's surface in its own frame; empty for a plane. O(vertices).
Bounds localBounds(const Scene& scene, const Body& body);

/// Whether a plane with this normal is drawn as ground rather than left out as a wall.
bool isFloor(const Vec3& normal);

/// World position of an anchor.
Vec3 worldPoint(const Anchor& anchor, const std::vector<RigidTransform>& worldFromBody);

/// Box in the world around a box of a body's frame.
Bounds transformed(const Bounds& local, const RigidTransform& worldFromLocal);

}  // namespace cradle
