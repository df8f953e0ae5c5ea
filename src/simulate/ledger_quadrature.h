#pragma once

#include "constraints/equations_of_motion.h"
#include "dynamics/integrators/step.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// J: so well the work of driven bodies in a step is to be known where the step's own sum of it may be less exact, else
/// infinite. Steps are as long as errors of the motion allow: of a body at rest, at which a driven one pulls, as long
/// as they like, though the pull changes all the time. Where contacts slide the sum is the exact one: it has the very
/// forces that the step has. `step` is as the integrator has left it.
double toleranceOfWork(const ChosenMethod& method, const Mechanism& mechanism, const Step& step);

/// Sets damping and work of `state`, at a fraction of a step, to what they are at its start and the integrals of their
/// rates along the interpolant: of degree 11, more exact than the interpolant of a sum. The step must be prepared
/// (prepareInterpolant), and the equations have the forces that acted in it. `tolerance` is that of an integral (J),
/// infinite for one formula.
void integrateLedger(EquationsOfMotion& equations, const Mechanism& mechanism, const Step& step, double fraction,
                     double tolerance, VectorX& state);

}  // namespace cradle
