#pragma once

#include "constraints/equations_of_motion.h"

namespace cradle {

/// Sums that a mechanism keeps, or changes only by what acts on it from outside.
struct Invariants {
  double kinetic = 0;                   // J
  double potential = 0;                 // J, -sum m g.x + springs
  Vec3 momentum = Vec3::Zero();         // kg m/s
  Vec3 angularMomentum = Vec3::Zero();  // kg m^2/s, about the world origin
};
Invariants invariantsOf(const Mechanism& mechanism, const VectorX& state);

/// Spin angular momentum (kg m^2/s, world) of a body about its centre of mass: R I R^T w.
Vec3 spinMomentum(const RigidBody& body, Eigen::Index index, const VectorX& state);

/// Kinetic energy in J, of one body or all.
double kineticEnergy(const RigidBody& body, Eigen::Index index, const VectorX& state);
double kineticEnergy(const std::vector<RigidBody>& bodies, const VectorX& state);

/// Kinetic and potential energy in J.
double mechanicalEnergy(const Mechanism& mechanism, const VectorX& state);

/// kinetic + potential + dissipated - work + numerical in J: constant to rounding if each operation that changes a
/// state books what it does.
double energyConstant(const Mechanism& mechanism, const VectorX& state);

/// Books as numerical what the energy constant of `state` lacks of `constant` (J): its value before an operation whose
/// laws have booked their part already.
void bookNumerical(double constant, const Mechanism& mechanism, VectorX& state);

/// The same for a projection that gives `before` the velocities that rows J ask for, J u + J_w w = b with the
/// velocities u of others, w of driven bodies and b of motors. It changes u by M du = J^T mu; driven bodies and motors
/// do the work mu . (b - J_w w) = mu . J u = du . M u by that, u that of `state`, however fast all move together.
void bookProjection(const VectorX& before, const Mechanism& mechanism, VectorX& state);

/// The same for an integrator's step: books its error at its end.
void bookStep(const Mechanism& mechanism, Step& step);

}  // namespace cradle
