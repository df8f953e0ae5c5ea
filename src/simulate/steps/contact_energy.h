#pragma once

#include <vector>

#include "dynamics/equations_of_motion.h"
#include "dynamics/invariants.h"

namespace cradle {

/// Kinetic and potential energy (J) of `bodies`, and of all springs.
double energyOf(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state);

/// Bodies that contact moves together.
struct MovedBodies {
  std::vector<int> bodies;
  bool isGrounded = false;  // something fixed touches or ties them
};

/// Bodies that touch only each other keep the momenta that they have in `free`, where motion without contact led: a
/// step's impulses act where contacts were at its start, not where the bodies are at its end. A motion of all of them
/// as one rigid body makes up for that, which no contact feels.
void keepMomenta(const MovedBodies& moved, const VectorX& free, const Mechanism& mechanism, VectorX& state);

/// Contact gives no energy: what bodies have more than `most` (J), by rounding, by the order of a method or by impulses
/// that were not found, is taken from their velocities. All become smaller by the same part, so that what touches opens
/// and slides as before; of bodies that touch only each other, relative to their motion as one rigid body, which has
/// their momenta. Returns how much energy (J) that took.
double limitEnergy(const MovedBodies& moved, double most, const Mechanism& mechanism, VectorX& state);

/// Whether energies (J) differ by more than rounding.
bool isGain(double energy, double most);

}  // namespace cradle
