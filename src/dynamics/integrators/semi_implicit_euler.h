#pragma once

#include "dynamics/integrators/step.h"

namespace cradle {

/// Velocities first, then positions with the new velocities (symplectic Euler). Order 1; on an undamped oscillator
/// stable up to h omega = 2, its energy bounded.
void semiImplicitEuler(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep,
                       Step& step);

}  // namespace cradle
