#pragma once

#include <functional>

#include "simulate/island_state.h"

namespace cradle {

/// Zero at an event, positive before it.
using EventFunction = std::function<double(const VectorX& state)>;

/// The interval in which an event is searched for (s, from the step's start), and the tolerance of its event function.
struct EventWindow {
  double guess = 0;      // the root on the step's interpolant
  double latest = 0;     // >= guess, not beyond the step's end: another event comes then
  double tolerance = 0;  // > 0
};

/// Takes the island's step again with a length at whose end `margin` is 0 to the tolerance, or else the longest one,
/// and returns its value there: above the tolerance the event has not come yet. So the state of an event is that of a
/// step, not of an interpolant.
double endStepAtEvent(IslandState& island, Integrator integrate, const EventWindow& window,
                      const EventFunction& margin);

}  // namespace cradle
