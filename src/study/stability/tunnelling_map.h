#pragma once

#include "dynamics/integrators/step.h"
#include "study/stability/maps.h"

namespace cradle {

/// What becomes of a body that is thrown at a plate.
enum class Passage {
  stopped,
  pushedThrough,  // overlapped at the end of a step, but beyond the middle: let out on the other side
  unseen          // passed without overlapping at the end of any step; of other methods, however it passed
};

/// Textbook collisions with a plate.
struct PlateTrial {
  double thickness, timeStep;  // m, s
  Integrator integrate;
};

/// The fastest (m/s) that a marble may be to be stopped, or to be seen, if a step begins at the worst moment: just
/// before it touches.
double fastestStopped(const PlateTrial& trial);
double fastestSeen(const PlateTrial& trial);

/// Speed against thickness of a plate: where marbles get through.
StabilityMap tunnellingMap(const MapProgress& progress);

}  // namespace cradle
