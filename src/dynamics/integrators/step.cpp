#include "dynamics/integrators/step.h"

#include <utility>

#include "core/error.h"
#include "dynamics/integrators/dop853.h"

namespace cradle {

void beginStep(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step) {
  step.time = time;
  step.timeStep = timeStep;
  step.startState = state;
  step.work.resize(state.size());
  step.hasEndRate = false;
  step.interpolant = InterpolantKind::cubicHermite;
  if (step.startRateIsKnown) {
    CRADLE_CHECK(step.startRate.size() == state.size());
  } else {
    step.startRate.resize(state.size());
    rightHandSide.rate(time, state, step.startRate);
  }
  step.startRateIsKnown = false;
}

void keepStartRate(Step& step) {
  step.startRateIsKnown = true;
}

void carryEndRate(Step& step) {
  if (!step.hasEndRate) return;
  std::swap(step.startRate, step.endRate);
  step.startRateIsKnown = true;
  step.hasEndRate = false;
}

void evaluateEndRate(const RightHandSide& rightHandSide, Step& step) {
  if (step.hasEndRate) return;
  step.hasEndRate = true;
  step.hasCorrections = false;
  step.endRate.resize(step.state.size());
  rightHandSide.rate(step.time + step.timeStep, step.state, step.endRate);
}

void prepareInterpolant(const RightHandSide& rightHandSide, Step& step) {
  evaluateEndRate(rightHandSide, step);
  if (step.interpolant != InterpolantKind::degreeSeven || step.hasCorrections) return;
  step.hasCorrections = true;
  computeCorrections(rightHandSide, step);
}

void interpolate(const Step& step, double fraction, VectorX& state) {
  CRADLE_CHECK(step.hasEndRate);
  const double s = fraction, r = 1 - fraction;
  state = (r * r * (1 + 2 * s)) * step.startState + (s * s * (1 + 2 * r)) * step.state +
          (step.timeStep * s * r) * (r * step.startRate - s * step.endRate);
  if (step.interpolant == InterpolantKind::degreeSeven) {
    const auto& c = step.corrections;
    state += (s * s * r * r) * (c[0] + s * (c[1] + r * (c[2] + s * c[3])));
  }
}

}  // namespace cradle
