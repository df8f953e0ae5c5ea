#pragma once

#include "constraints/equations_of_motion.h"

namespace cradle {

/// A way in which a mechanism swings on its springs: x'' = -stiffness x - damping x'.
struct SpringMode {
  double stiffness = 0;    // 1/s^2: its root is the frequency in rad/s
  double damping = 0;      // 1/s
  std::size_t spring = 0;  // index of the one that has the largest part in it
};

/// The mode with the largest stiffness, and the one with the largest damping, of all springs together, for small
/// motions from `state` that rods and joints allow. Zero without springs. How forces turn with their springs is left
/// out. O(springs).
SpringMode stiffestMode(const Mechanism& mechanism, const VectorX& state);
SpringMode mostDampedMode(const Mechanism& mechanism, const VectorX& state);

}  // namespace cradle
