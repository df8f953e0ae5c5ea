#pragma once

#include <optional>

#include "experiments/scene_sketch.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// All bodies as one island without a method, each of which may touch all others whatever a plan says.
IslandPlan touchingScene(const Scene& scene);

/// Where the last body of a sketch is nearest to the others.
struct NearestPlace {
  double separation = 0;       // m
  int other = 0;               // body
  Vec3 point = Vec3::Zero();   // m, world
  Vec3 normal = Vec3::Zero();  // unit, from the last body to the other
};

/// None if nothing is near enough for the broad phase.
std::optional<NearestPlace> nearestPlace(const SceneSketch& sketch);

/// Moves the last body of a sketch along `direction` (unit), from far back, until its separation from the others is
/// `gap` (m). False if it misses them.
bool moveToTouch(SceneSketch& sketch, const Vec3& direction, double gap);

}  // namespace cradle
