#pragma once

#include "study/stability/fixed_step_trial.h"

namespace cradle {

/// What a method makes of a body that turns over, from the best to the worst.
enum class Tumbling {
  right,
  flipsWrong,   // at some time it spins the other way round than it should
  energyWrong,  // off by more than 10 %
  stopped       // as unstable
};

/// A body with moments of inertia 1, 2 and 3 kg m^2 that spins at `speed` (rad/s) about the middle axis, tilted by 1 %.
Scene tumblingScene(double speed);

/// That body until it has turned by 60 rad and turned over three times; at least 30 steps. The truth is the closed
/// form.
Tumbling tumblingOf(double speed, const FixedStepMethod& method, double timeStep);

}  // namespace cradle
