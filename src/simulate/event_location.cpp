#include "simulate/event_location.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr int kMostCorrections = 60;  // steps tried to find an event; 3 are usual

}  // namespace

// The Illinois variant of regula falsi (M. Dowell, P. Jarratt, 1971).
void endStepAtEvent(MovingIsland& island, Integrator integrate, double guess, double tolerance,
                    const EventMargin& margin) {
  Step& step = island.step;
  const double whole = step.timeStep;
  const auto marginAfter = [&](double part) {
    keepStartRate(step);
    integrate(island.rightHandSide, island.state, island.time, part, step);
    return margin(step.state);
  };
  double early = 0,
         earlyMargin = std::max(margin(island.state), tolerance);  // a rope that rebounds starts at its length
  double late = guess, lateMargin = marginAfter(late);
  while (lateMargin > 0 && late < whole) {  // the method is later than its interpolant
    early = late, earlyMargin = lateMargin;
    late = std::min(whole, 2 * late), lateMargin = marginAfter(late);
  }
  double earlyWeight = earlyMargin, lateWeight = lateMargin;
  for (int i = 0; i < kMostCorrections && lateMargin < -tolerance; ++i) {
    const double part = late + (early - late) * lateWeight / (lateWeight - earlyWeight);
    const double found = marginAfter(part);
    if (std::abs(found) <= tolerance) return;
    if (found > 0) {
      early = part, earlyWeight = found, lateWeight /= 2;
    } else {
      late = part, lateMargin = lateWeight = found, earlyWeight /= 2;
    }
  }
  keepStartRate(step);
  integrate(island.rightHandSide, island.state, island.time, late, step);
}

}  // namespace cradle
