#pragma once

#include <vector>

#include "impact/pairwise.h"

namespace cradle {

/// Energy (J) that an impulse (N s) on one body of two takes from them, while that body's velocity relative to the
/// other goes from `before` to `after` (m/s): it works with the mean of both (Lord Kelvin, P. G. Tait, "Treatise on
/// Natural Philosophy", 1867, 308). < 0 if it gives.
inline double energyTaken(const Vec3& impulse, const Vec3& before, const Vec3& after) {
  return -0.5 * impulse.dot(before + after);
}

/// Books what one simultaneous impact took from bodies that had the velocities of `before` and have those of `state`
/// now, at the same places: the work of its impulses, and what they lost where that is the same to rounding of these;
/// and the work of what drives bodies against them.
void bookImpact(const std::vector<ImpactContact>& impacts, const std::vector<RigidBody>& bodies, const VectorX& before,
                VectorX& state);

}  // namespace cradle
