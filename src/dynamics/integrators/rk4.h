#pragma once

#include "dynamics/integrators/step.h"

namespace cradle {

/// The classical Runge-Kutta method. Order 4; on an undamped oscillator stable up to h omega = 2 sqrt(2).
void rk4(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step);

/// Estimate of the local error of a step that rk4 has just taken, scaled 1 + |x|: that of order 3, which is larger. NaN
/// if that is not finite. The step's end derivative must be there (prepareInterpolant).
double rk4Error(const Step& step, Eigen::Index components);

}  // namespace cradle
