#pragma once

#include "study/stability/maps.h"

namespace cradle {

/// A law for impacts of many bodies at once.
enum class ImpactLaw { generalizedReflections, pairwise, newtonAllAtOnce };

/// Speeds (m/s) of five touching balls after the first `moving` of them hit the others at 1 m/s: by a law alone.
std::vector<double> speedsAfter(ImpactLaw law, int moving);

/// The same 0.1 s later, by the plan of the scene.
std::vector<double> speedsByPlan(int moving);

/// Newton's cradle by law of impact, and in other engines.
StabilityMap cradleMap(const MapProgress& progress);

}  // namespace cradle
