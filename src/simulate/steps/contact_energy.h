#pragma once

#include <vector>

#include "dynamics/equations_of_motion.h"

namespace cradle {

/// Kinetic and potential energy (J) of `bodies`, and of all springs.
double energyOf(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state);

/// Contact gives no energy: what `bodies` have more than `most` (J), by rounding, by the order of a method or by
/// impulses that were not found, is taken from their velocities. All become smaller by the same part, so that what
/// touches opens and slides as before.
void limitEnergy(const std::vector<int>& bodies, double most, const Mechanism& mechanism, VectorX& state);

/// Whether energies (J) differ by more than rounding.
bool isGain(double energy, double most);

}  // namespace cradle
