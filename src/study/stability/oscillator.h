#pragma once

#include "study/stability/fixed_step_trial.h"

namespace cradle {

/// A ball of 1 kg on a spring, free of gravity, pulled out by kOscillatorAmplitude and let go.
struct Oscillator {
  double omega = 1;         // rad/s
  double dampingRatio = 0;  // of critical damping, >= 0
};
constexpr double kOscillatorAmplitude = 0.01;  // m: 1 % of the rest length

Scene oscillatorScene(const Oscillator& oscillator);

/// How far (m) its spring is pulled out at a time (s), in closed form.
double oscillatorStretch(const Oscillator& oscillator, double time);

/// Unstable if a run of ten periods, and of 300 steps at the least, is stopped; inaccurate if off by more than 10 % of
/// the amplitude at the end of a step within ten periods.
Stability oscillatorStability(const Oscillator& oscillator, const FixedStepMethod& method, double timeStep);

/// The longest stable step (s) as runs of 1000 steps show it, from step x omega = 0.07 on; 0 if that is not.
double measuredOscillatorLimit(const Oscillator& oscillator, const FixedStepMethod& method);

}  // namespace cradle
