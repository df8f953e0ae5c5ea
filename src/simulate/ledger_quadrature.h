#pragma once

#include "constraints/equations_of_motion.h"
#include "dynamics/integrators/step.h"
#include "math/running_integral.h"
#include "simulate/plan/plan.h"

namespace cradle {

/// J: so well the work of driven bodies, and of motors that hold, in a step is to be known where the step's own sum of
/// it may be less exact, else infinite. Steps are as long as errors of the motion allow: of a body at rest, at which a
/// driven one pulls, as long as they like, though the pull changes all the time. Where contacts slide the sum is the
/// exact one: it has the very forces that the step has. `step` is as the integrator has left it.
double toleranceOfWork(const ChosenMethod& method, const Mechanism& mechanism, const Step& step);

/// The integral of the ledger's rates along the interpolant, from a step's start up to fractions of it, to a tolerance
/// (J). The step must be prepared (prepareInterpolant), and the equations have the forces that acted in it.
RunningIntegral integralOfLedger(EquationsOfMotion& equations, const Mechanism& mechanism, const Step& step,
                                 double tolerance);

/// Sets damping and work of `state`, at a fraction of a step, to that.
void setLedger(const RunningIntegral& integral, const Step& step, double fraction, VectorX& state);

}  // namespace cradle
