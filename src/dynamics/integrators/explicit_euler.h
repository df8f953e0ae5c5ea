#pragma once

#include "dynamics/integrators/step.h"

namespace cradle {

/// y1 = y0 + h f(t0, y0). Order 1. Never stable on an undamped oscillator: its energy grows by 1 + (h omega)^2 a step.
void explicitEuler(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step);

}  // namespace cradle
