#pragma once

#include <vector>

#include "constraints/constraint_forces.h"
#include "impact/pairwise.h"

namespace cradle {

/// Energy (J) that an impulse (N s) on one body of two takes from them, while that body's velocity relative to the
/// other goes from `before` to `after` (m/s): it works with the mean of both (Lord Kelvin, P. G. Tait, "Treatise on
/// Natural Philosophy", 1867, 308). < 0 if it gives.
inline double energyTaken(const Vec3& impulse, const Vec3& before, const Vec3& after) {
  return -0.5 * impulse.dot(before + after);
}

/// `state` with the velocities of driven bodies and those that constraints lead the others to, of the least kinetic
/// energy. An impulse p (N s, on B) at a contact, and what constraints answer to it, make what drives bodies work by
/// -p . v (J), v the velocity (m/s) of B relative to A there. The solver must be factorised for `state`.
VectorX ledVelocities(const std::vector<RigidBody>& bodies, ConstraintSolver& constraints, const VectorX& state);

/// Books what one simultaneous impact took from bodies that had the velocities of `before` and have those of `state`
/// now, at the same places: the work of its impulses, and what they lost where that is the same to rounding of these;
/// and the work of what drives bodies against them. The solver must be factorised for these places.
void bookImpact(const std::vector<ImpactContact>& impacts, const std::vector<RigidBody>& bodies,
                ConstraintSolver& constraints, const VectorX& before, VectorX& state);

}  // namespace cradle
