#pragma once

#include <array>
#include <functional>
#include <vector>

#include "math/types.h"

namespace cradle {

/// An ordinary differential equation y' = f(t, y). The leading `positions` components of y are positions: methods that
/// treat velocities first ask for their derivatives alone.
struct RightHandSide {
  std::function<void(double time, const VectorX& state, VectorX& derivative)> derivative;
  std::function<void(const VectorX& state, VectorX& derivative)>
      positionRate;  // writes the leading `positions` entries
  Eigen::Index positions = 0;
};

/// What goes through a step, with s = fraction of the step, r = 1 - s:
///   cubicHermite  the cubic through state and derivative at both ends; order 3
///   degreeFour    that cubic + s^2 r^2 c0, c0 = Step::corrections[0]; Dormand and Prince's of order 4
///   degreeSeven   that cubic + s^2 r^2 (c0 + s (c1 + r (c2 + s c3))), c0 ... c3 = Step::corrections; DOP853's, order 7
enum class InterpolantKind { cubicHermite, degreeFour, degreeSeven };

/// One step of an integrator: the new state, and what is needed to interpolate inside it and to judge it.
struct Step {
  double time = 0, timeStep = 0;  // s: the step covers [time, time + timeStep]
  VectorX startState, startDerivative;
  VectorX state, endDerivative;  // at time + timeStep
  bool hasEndDerivative = false;
  bool hasCorrections = false;
  bool startDerivativeIsKnown = false;  // startDerivative already holds the derivative at the start of the step to come
  InterpolantKind interpolant = InterpolantKind::cubicHermite;
  std::array<VectorX, 4> corrections;
  std::vector<VectorX> stageDerivatives;  // numbered as in the table of the method; start and end have their own fields
  VectorX work, stage;                    // scratch, kept so that a step allocates nothing
};

/// An integrator advances `state` by `timeStep` and leaves the result in `step`.
using Integrator = void (*)(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep,
                            Step& step);

/// Local error of a step that an integrator has taken, in units of the tolerance of each component. Above 1 the step is
/// to be taken again; NaN if it left the finite numbers.
using ErrorNorm = double (*)(const Step& step, const VectorX& tolerance);

/// What all integrators begin with: notes the start and evaluates its derivative, unless that is known.
void beginStep(const RightHandSide& rightHandSide, const VectorX& state, double time, double timeStep, Step& step);

/// The next step starts where this one started: it is the same one with another length. Nothing that the derivative
/// depends on may have changed.
void keepStartDerivative(Step& step);

/// The next step starts where this one ended, at the very same state, and nothing else that the derivative depends on
/// has changed: its start derivative is this one's end derivative, if that was evaluated. The step can be neither
/// interpolated nor judged any more.
void carryEndDerivative(Step& step);

/// Evaluates the derivative at the end of the step, unless it is there already.
void evaluateEndDerivative(const RightHandSide& rightHandSide, Step& step);

/// Evaluates what interpolate needs, unless it is there already: the derivative at the end of the step, with DOP853
/// three more.
void prepareInterpolant(const RightHandSide& rightHandSide, Step& step);

/// Frees what only the stages need, if the step may be interpolated without them.
void releaseStages(Step& step);

/// State at time + fraction * timeStep by the step's interpolant, exact at both ends. 0 <= fraction <= 1.
void interpolate(const Step& step, double fraction, VectorX& state);

/// The interpolant's derivative there (1/s), which is the right-hand side's at both ends.
void interpolateRate(const Step& step, double fraction, VectorX& rate);

/// Ends a step whose interpolant is of degree 4, and prepared, at a fraction of it: what is left is the same curve.
void cutStep(double fraction, Step& step);

}  // namespace cradle
