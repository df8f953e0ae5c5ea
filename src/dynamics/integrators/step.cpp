#include "dynamics/integrators/step.h"

#include <utility>

#include "core/error.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/dormand_prince5.h"

namespace cradle {

void beginStep(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  step.time = time;
  step.timeStep = timeStep;
  step.startState = state;
  step.work.resize(state.size());
  step.hasEndDerivative = false;
  step.interpolant = InterpolantKind::cubicHermite;
  if (step.startDerivativeIsKnown) {
    CRADLE_CHECK(step.startDerivative.size() == state.size());
  } else {
    step.startDerivative.resize(state.size());
    rightHandSide.derivative(time, state, step.startDerivative);
  }
  step.startDerivativeIsKnown = false;
}

void keepStartDerivative(Step& step) {
  step.startDerivativeIsKnown = true;
}

void carryEndDerivative(Step& step) {
  if (!step.hasEndDerivative) return;
  std::swap(step.startDerivative, step.endDerivative);
  step.startDerivativeIsKnown = true;
  step.hasEndDerivative = false;
}

void evaluateEndDerivative(const RightHandSide& rightHandSide, Step& step) {
  if (step.hasEndDerivative) return;
  step.hasEndDerivative = true;
  step.hasCorrections = false;
  step.endDerivative.resize(step.state.size());
  rightHandSide.derivative(step.time + step.timeStep, step.state, step.endDerivative);
}

void prepareInterpolant(const RightHandSide& rightHandSide, Step& step) {
  evaluateEndDerivative(rightHandSide, step);
  if (step.interpolant == InterpolantKind::cubicHermite || step.hasCorrections) return;
  step.hasCorrections = true;
  if (step.interpolant == InterpolantKind::degreeFour)
    computeDormandPrince5Correction(step);
  else
    dop853Corrections(rightHandSide, step);
}

void releaseStages(Step& step) {
  if (step.hasCorrections) step.stageDerivatives = {};
}

void interpolate(const Step& step, double fraction, VectorX& state) {
  CRADLE_CHECK(step.hasEndDerivative);
  const double s = fraction, r = 1 - fraction;
  state = (r * r * (1 + 2 * s)) * step.startState + (s * s * (1 + 2 * r)) * step.state +
          (step.timeStep * s * r) * (r * step.startDerivative - s * step.endDerivative);
  const auto& c = step.corrections;
  if (step.interpolant == InterpolantKind::degreeFour) state += (s * s * r * r) * c[0];
  if (step.interpolant == InterpolantKind::degreeSeven)
    state += (s * s * r * r) * (c[0] + s * (c[1] + r * (c[2] + s * c[3])));
}

void interpolateRate(const Step& step, double fraction, VectorX& rate) {
  CRADLE_CHECK(step.hasEndDerivative);
  const double s = fraction, r = 1 - fraction, length = step.timeStep;
  rate = (6 * s * r / length) * (step.state - step.startState) + (r * (r - 2 * s)) * step.startDerivative +
         (s * (s - 2 * r)) * step.endDerivative;
  const auto& c = step.corrections;
  const double slope = 2 * s * r * (r - s) / length;
  if (step.interpolant == InterpolantKind::degreeFour) rate += slope * c[0];
  if (step.interpolant == InterpolantKind::degreeSeven)
    rate += slope * (c[0] + s * (c[1] + r * (c[2] + s * c[3]))) +
            (s * s * r * r / length) * (c[1] + (r - s) * c[2] + s * (2 * r - s) * c[3]);
}

// The part of a polynomial of degree 4 has the fourth power of its length as the factor of its leading coefficient.
void cutStep(double fraction, Step& step) {
  CRADLE_CHECK(step.interpolant == InterpolantKind::degreeFour && step.hasCorrections);
  const double s = fraction;
  interpolate(step, fraction, step.stage);
  interpolateRate(step, fraction, step.work);
  std::swap(step.state, step.stage);
  std::swap(step.endDerivative, step.work);
  step.corrections[0] *= s * s * s * s;
  step.timeStep *= fraction;
}

}  // namespace cradle
