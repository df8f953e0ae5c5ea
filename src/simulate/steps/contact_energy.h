#pragma once

#include <vector>

#include "collision/root_bracketing.h"
#include "constraints/equations_of_motion.h"
#include "constraints/invariants.h"
#include "simulate/steps/step_tolerances.h"

namespace cradle {

/// Kinetic and potential energy (J) of `bodies`, and of all springs.
double energyOf(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state);

/// Motions of bodies as one rigid body, columns that are orthonormal: linear velocity (m/s) of their centre of mass and
/// angular velocity (rad/s), world.
using RigidMotions = Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

/// Bodies that contact moves together, and their common rigid motions that nothing fixed hinders: impulses between them
/// leave the momenta of these motions as they are. All six, where nothing fixed touches them or is joined to them.
struct MovedBodies {
  std::vector<int> bodies;
  RigidMotions kept = RigidMotions::Identity(6, 6);
};

/// Restricts `kept` to the motions along a plane without friction: translations along it and the rotation about its
/// normal. None are left if another plane has done so before.
void hinderByPlane(const Vec3& normal, RigidMotions& kept);

/// Restores the momenta of the kept motions to those of `free`, the end of motion without contact: a step's impulses
/// act where contacts were at its start, not where the bodies are at its end. The bodies are moved as one rigid body
/// for that, so that no contact changes.
void keepMomenta(const MovedBodies& moved, const VectorX& free, const Mechanism& mechanism, VectorX& state);

/// Contact gives no energy: energy above `most` (J), which comes of rounding, of the order of a method or of impulses
/// that were not found, is taken from the velocities relative to the kept motion that has the bodies' momenta. All are
/// scaled by one factor, so that contacts open and slide as before. Returns the energy (J) that this took.
double clampEnergy(const MovedBodies& moved, double most, const Mechanism& mechanism, VectorX& state);

/// Whether `energy` exceeds `most` (J) by more than rounding.
bool isGain(double energy, double most);

/// The largest fraction of the restitutions with which no energy is gained: the root of lossWith(fraction), the energy
/// (J) that an impact then takes. `lossOfAll` < 0 is that of the fraction 1. Newton's restitution with friction may
/// gain energy.
template <class LossWith>
double fractionWithoutGain(const LossWith& lossWith, double lossOfAll) {
  Bracket fractions{0, lossWith(0), 1, lossOfAll};
  if (fractions.gapBefore > 0) closeBracket(lossWith, fractions, StepTolerances::kRestitutionError);
  return fractions.before;
}

}  // namespace cradle
