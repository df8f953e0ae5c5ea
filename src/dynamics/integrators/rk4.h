#pragma once

#include "dynamics/integrators/step.h"

namespace cradle {

/// The classical Runge-Kutta method. Order 4; on an undamped oscillator stable up to h omega = 2 sqrt(2).
void rk4(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step);

}  // namespace cradle
