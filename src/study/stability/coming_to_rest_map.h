#pragma once

#include <optional>

#include "scene/scene.h"
#include "study/stability/maps.h"

namespace cradle {

/// When (s) a ball dropped from 1 m comes to rest after infinitely many bounces: t1 (1 + e) / (1 - e), t1 the time of
/// the fall. e < 1.
double zenoTime(double restitution);

/// The same as an event of the scene's plan, or of a method that it names; NaN if it does not come to rest within twice
/// the time.
double measuredRestTime(double restitution, const std::optional<Method>& method);

/// With textbook collisions and semi-implicit Euler, which have no rest: when the ball was last faster than gravity
/// makes it in two steps; and how deep (m) it is in the ground a second later.
struct TextbookRest {
  double time = 0, depth = 0;
};
TextbookRest textbookRest(double restitution, double timeStep);

/// When that is to be expected: each bounce leaves the height that it does in the mean (bounce_energy_map.h).
double expectedTextbookRestTime(double restitution, double timeStep);

/// Restitution against the error of the time of rest.
StabilityMap comingToRestMap(const MapProgress& progress);

}  // namespace cradle
