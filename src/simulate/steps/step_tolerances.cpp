#include "simulate/steps/step_tolerances.h"

#include "simulate/thresholds.h"

namespace cradle {

StepScales stepScalesOf(const Assembly& assembly) {
  return {smallestSize(assembly.geometry), assembly.mechanism.gravity.norm()};
}

StepTolerances stepTolerancesOf(const StepScales& scales) {
  StepTolerances made;
  made.scales = scales;
  made.touch = StepTolerances::kStepTouchRatio * scales.size;
  made.overlap = StepTolerances::kOverlapRatio * scales.size;
  made.support = StepTolerances::kSupportRatio * scales.size;
  made.closedGap = StepTolerances::kClosedGapRatio * made.touch;
  made.residualAcceleration = StepTolerances::kRestResidualRatio * scales.gravity;
  made.forceError = StepTolerances::kForcesSolvedRatio * StepTolerances::kRestResidualRatio * scales.gravity;
  return made;
}

double StepTolerances::speedOf(double ratio, double h) const {
  return kRestSpeedFloor + ratio * scales.gravity * h;
}

double StepTolerances::maxRestSpeed(double pressing, double h) const {
  return kRestSteps * pressing + kMinImpactRatio * scales.gravity * h + kRestSpeedFloor;
}

}  // namespace cradle
