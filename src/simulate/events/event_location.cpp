#include "simulate/events/event_location.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr int kMaxCorrections = 60;  // steps tried to find an event; 3 are usual

constexpr double kStepRounding = 1e-14;  // of the step: a narrower bracket is rounding
constexpr double kFirstBracket = 1e-6;   // of the step: half of the first bracket around the guess
constexpr double kBracketGrowth = 16;    // from one bracket to the next

}  // namespace

// The Illinois variant of regula falsi (M. Dowell, P. Jarratt, 1971), each value of the event function from a step of
// its own.
double endStepAtEvent(IslandState& island, Integrator integrate, const EventWindow& window,
                      const EventFunction& margin) {
  Step& step = island.step;
  const double whole = step.timeStep, tolerance = window.tolerance;
  const auto marginAfter = [&](double part) {
    keepStartDerivative(step);
    island.integrate(integrate, part);
    return margin(step.state);
  };
  double late = window.guess, lateMargin = marginAfter(late);
  if (std::abs(lateMargin) <= tolerance || (lateMargin > 0 && late >= window.latest)) return lateMargin;
  double early = 0, earlyMargin = tolerance, reach = kFirstBracket * whole;
  while (lateMargin > 0 && late < window.latest) {  // the event of the method is later than that of its interpolant
    early = late, earlyMargin = lateMargin;
    late = std::min(window.latest, late + reach), lateMargin = marginAfter(late), reach *= kBracketGrowth;
  }
  // Backwards from the guess: a contact, or a rope, that has just rebounded has a root at the start of the step too.
  for (double part = window.guess - reach; early == 0 && part > 0; part -= reach, reach *= kBracketGrowth) {
    const double found = marginAfter(part);
    if (found > 0)
      early = part, earlyMargin = found;
    else
      late = part, lateMargin = found;
  }
  double earlyWeight = earlyMargin, lateWeight = lateMargin;
  for (int i = 0; i < kMaxCorrections && lateMargin < -tolerance && late - early > kStepRounding * whole; ++i) {
    const double part = late + (early - late) * lateWeight / (lateWeight - earlyWeight);
    const double found = marginAfter(part);
    if (std::abs(found) <= tolerance) return found;
    if (found > 0) {
      early = part, earlyWeight = found, lateWeight /= 2;
    } else {
      late = part, lateMargin = lateWeight = found, earlyWeight /= 2;
    }
  }
  return marginAfter(late);
}

}  // namespace cradle
