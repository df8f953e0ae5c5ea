#pragma once

#include <functional>

#include "math/types.h"

namespace cradle {

/// An ordinary differential equation y' = f(t, y). The leading `positions` components of y are positions: methods that
/// treat velocities first ask for their rates alone.
struct RightHandSide {
  std::function<void(double time, const VectorX& state, VectorX& rate)> rate;
  std::function<void(const VectorX& state, VectorX& rate)> positionRate;  // writes the leading `positions` entries
  Eigen::Index positions = 0;
};

/// One step of an integrator: the new state, and what is needed to interpolate inside it.
struct Step {
  double time = 0, timeStep = 0;  // s: the step covers [time, time + timeStep]
  VectorX startState, startRate;
  VectorX state, endRate;  // at time + timeStep
  bool hasEndRate = false;
  VectorX work, stage;  // scratch, kept so that a step allocates nothing
};

/// An integrator advances `state` by `timeStep` and leaves the result in `step`.
using Integrator = void (*)(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep,
                            Step& step);

/// What all integrators begin with: notes the start and evaluates its rate.
void beginStep(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step);

/// Evaluates the rate at the end of the step, which interpolate needs, unless it is there already.
void prepareInterpolant(const RightHandSide& rightHandSide, Step& step);

/// Cubic Hermite interpolant at time + fraction * timeStep (order 3; exact at both ends). 0 <= fraction <= 1.
void interpolate(const Step& step, double fraction, VectorX& state);

}  // namespace cradle
