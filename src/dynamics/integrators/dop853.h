#pragma once

#include "dynamics/integrators/step.h"

namespace cradle {

/// The method of Dormand and Prince, order 8 with 12 evaluations; on an undamped oscillator stable up to h omega
/// = 5.96. Its step holds an error estimate (dop853Error) and an interpolant of order 7.
void dop853(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step);

/// Local error of a step of DOP853 in units of the tolerance: the largest over all components of error_i /
/// (tolerance_i (1 + |y_i|)), so that one stiff body among many counts. Proportional to timeStep^8. NaN if the step
/// left the finite numbers.
double dop853Error(const Step& step, const VectorX& tolerance);

/// Evaluates the three further derivatives of the interpolant and from them Step::corrections. Needs the end
/// derivative; part of prepareInterpolant.
void dop853Corrections(const RightHandSide& rightHandSide, Step& step);

}  // namespace cradle
