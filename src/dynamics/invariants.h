#pragma once

#include "dynamics/equations_of_motion.h"

namespace cradle {

/// Sums that a mechanism keeps, or changes only by what acts on it from outside.
struct Invariants {
  double kinetic = 0;                   // J
  double potential = 0;                 // J, -sum m g.x + springs
  Vec3 momentum = Vec3::Zero();         // kg m/s
  Vec3 angularMomentum = Vec3::Zero();  // kg m^2/s, about the world origin
};
Invariants invariantsOf(const Mechanism& mechanism, const VectorX& state);

/// Kinetic energy in J, of one body or all.
double kineticEnergy(const RigidBody& body, Eigen::Index index, const VectorX& state);
double kineticEnergy(const std::vector<RigidBody>& bodies, const VectorX& state);

/// kinetic + potential + dissipated - work in J: constant up to the error of the method.
double energyConstant(const Mechanism& mechanism, const VectorX& state);

}  // namespace cradle
