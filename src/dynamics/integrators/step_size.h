#pragma once

#include "dynamics/integrators/step.h"

namespace cradle {

constexpr double kShortestTimeStep = 1e-14;  // of a run's duration: shorter steps are rounding, the run has to stop

/// Step-size control: the step to try next, and whether the last try failed.
struct StepSize {
  double timeStep = 0;  // s
  int order = 8;        // 8 or 5: the power of a step's length that its error norm goes with
  bool afterRejection = false;
};

/// Whether a step of length `taken` (s) with that error norm stands (error norm <= 1); else it has to be taken again.
/// Sets the step to try next. A step that an event cut short says nothing against the length that was planned, if it
/// could have been longer by more than one step may grow. An error norm that is not finite counts as rejection.
bool acceptStep(double errorNorm, double taken, StepSize& size);

/// A first step (s) for which the error norm of a method, DOP853 or one of another `order`, is about 1 or less, with
/// one more evaluation. Needs a `step` begun with beginStep at the start, whatever its length; it keeps its start
/// derivative for the first step itself.
double firstTimeStep(const RightHandSide& rightHandSide, const VectorX& tolerance, Step& step, int order);

}  // namespace cradle
