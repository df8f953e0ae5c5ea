#pragma once

#include "dynamics/integrators/step.h"

namespace cradle {

/// The method of Dormand and Prince, order 5 with 6 evaluations, the last of them at the end of the step. Its step
/// holds an error estimate (dormandPrince5Error) and an interpolant of order 4, whose error is of the size of that
/// estimate, for no more.
void dormandPrince5(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step);

/// Local error of such a step in units of the tolerance, as dop853Error has it for DOP853. Proportional to timeStep^5.
double dormandPrince5Error(const Step& step, const VectorX& tolerance);

/// The correction of the interpolant, from the derivatives of the step; part of prepareInterpolant.
void computeDormandPrince5Correction(Step& step);

}  // namespace cradle
