#pragma once

#include <functional>

#include "simulate/moving_island.h"

namespace cradle {

/// Zero at an event, positive before it.
using EventMargin = std::function<double(const VectorX& state)>;

/// Takes the island's step again with a length (s) at whose end `margin` is between 0 and `tolerance`. `guess` (s) is
/// the interpolant's, not beyond the step's end; the state of an event is that of a step, never the interpolant's.
void endStepAtEvent(MovingIsland& island, Integrator integrate, double guess, double tolerance,
                    const EventMargin& margin);

}  // namespace cradle
