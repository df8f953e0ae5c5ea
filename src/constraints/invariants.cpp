#include "constraints/invariants.h"

namespace cradle {

Vec3 spinMomentum(const RigidBody& body, Eigen::Index index, const VectorX& state) {
  const Vec3 spin = angularVelocity(state, index);
  if (spin == Vec3::Zero()) return spin;
  const Quat worldFromBody = orientation(state, index).normalized();
  return worldFromBody * (body.inertiaTensor * (worldFromBody.conjugate() * spin));
}

double kineticEnergy(const RigidBody& body, Eigen::Index index, const VectorX& state) {
  return 0.5 * body.mass * linearVelocity(state, index).squaredNorm() +
         0.5 * angularVelocity(state, index).dot(spinMomentum(body, index, state));
}

double kineticEnergy(const std::vector<RigidBody>& bodies, const VectorX& state) {
  double energy = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    energy += kineticEnergy(bodies[i], static_cast<Eigen::Index>(i), state);
  return energy;
}

Invariants invariantsOf(const Mechanism& mechanism, const VectorX& state) {
  Invariants sums;
  sums.kinetic = kineticEnergy(mechanism.bodies, state);
  for (std::size_t i = 0; i < mechanism.bodies.size(); ++i) {
    const Eigen::Index body = static_cast<Eigen::Index>(i);
    const Vec3 position = centerOfMass(state, body);
    const Vec3 momentum = mechanism.bodies[i].mass * linearVelocity(state, body);
    sums.potential -= mechanism.bodies[i].mass * mechanism.gravity.dot(position);
    sums.momentum += momentum;
    sums.angularMomentum += position.cross(momentum) + spinMomentum(mechanism.bodies[i], body, state);
  }
  for (const SpringForce& spring : mechanism.springs) sums.potential += actionOf(spring, state).potential;
  return sums;
}

double mechanicalEnergy(const Mechanism& mechanism, const VectorX& state) {
  double energy = kineticEnergy(mechanism.bodies, state);
  for (std::size_t i = 0; i < mechanism.bodies.size(); ++i)
    energy -= mechanism.bodies[i].mass * mechanism.gravity.dot(centerOfMass(state, static_cast<Eigen::Index>(i)));
  for (const SpringForce& spring : mechanism.springs) energy += actionOf(spring, state).potential;
  return energy;
}

double energyConstant(const Mechanism& mechanism, const VectorX& state) {
  return mechanicalEnergy(mechanism, state) + dissipatedEnergy(state) - pushWork(state) + numericalEnergy(state);
}

void bookNumerical(double constant, const Mechanism& mechanism, VectorX& state) {
  numericalEnergy(state) += constant - energyConstant(mechanism, state);
}

void bookProjection(const VectorX& before, const Mechanism& mechanism, VectorX& state) {
  if (!mechanism.driven.empty() || !mechanism.motors.empty())
    for (std::size_t i = 0; i < mechanism.bodies.size(); ++i) {
      if (mechanism.bodies[i].isDriven()) continue;
      const auto body = static_cast<Eigen::Index>(i);
      const Vec3 change = linearVelocity(state, body) - linearVelocity(before, body),
                 turn = angularVelocity(state, body) - angularVelocity(before, body);
      pushWork(state) += mechanism.bodies[i].mass * change.dot(linearVelocity(state, body)) +
                         turn.dot(spinMomentum(mechanism.bodies[i], body, state));
    }
  bookNumerical(energyConstant(mechanism, before), mechanism, state);
}

void bookStep(const Mechanism& mechanism, Step& step) {
  bookNumerical(energyConstant(mechanism, step.startState), mechanism, step.state);
}

}  // namespace cradle
