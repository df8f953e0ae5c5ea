#pragma once

#include "study/stability/fixed_step_trial.h"

namespace cradle {

constexpr double kBoxDuration = 0.5;  // s

/// A box that hangs by one corner from a spring, as in the scene hung_box, and starts upright and at rest. The spring
/// pulls beside the centre of mass, and so moves less mass than the box has. dampingRatio: times critical for that
/// mass.
Scene hungBox(double stiffness, double dampingRatio);

/// Frequency (rad/s) of the spring at the start.
double boxOmega(const Scene& scene);

/// Whether a run of kBoxDuration, and of 300 steps at the least, is not stopped.
bool isBoxStable(Scene& scene, const FixedStepMethod& method, double timeStep);

/// The longest stable step (s) as such runs show it, from step x omega = 0.07 on; 0 if that is not.
double measuredBoxLimit(Scene& scene, const FixedStepMethod& method);

}  // namespace cradle
