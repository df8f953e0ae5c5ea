#pragma once

#include <functional>

#include "simulate/island_state.h"

namespace cradle {

/// Zero at an event, positive before it.
using EventFunction = std::function<double(const VectorX& state)>;

/// Where an event is looked for (s, from the step's start), and how well (in units of its margin).
struct EventWindow {
  double guess = 0;      // the interpolant's
  double latest = 0;     // >= guess, not beyond the step's end: other events come then
  double tolerance = 0;  // > 0
};

/// Takes the island's step again with a length at whose end `margin` is 0 to the tolerance, or the longest one, and
/// returns the margin there: beyond the tolerance the event has not come yet. The state of an event is that of a step,
/// never the interpolant's.
double endStepAtEvent(IslandState& island, Integrator integrate, const EventWindow& window,
                      const EventFunction& margin);

}  // namespace cradle
