#include "simulate/steps/contact_energy.h"

#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

constexpr double kEnergyRounding = 1e-13;  // of the energy

double kineticEnergyOf(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state) {
  double energy = 0;
  for (const int body : bodies) energy += kineticEnergy(mechanism.bodies[static_cast<std::size_t>(body)], body, state);
  return energy;
}

Vec3 meanVelocity(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state) {
  Vec3 momentum = Vec3::Zero();
  double mass = 0;
  for (const int body : bodies) {
    const double m = mechanism.bodies[static_cast<std::size_t>(body)].mass;
    mass += m, momentum += m * linearVelocity(state, body);
  }
  return momentum / mass;
}

}  // namespace

double energyOf(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state) {
  double energy = kineticEnergyOf(bodies, mechanism, state);
  for (const int body : bodies)
    energy -= mechanism.bodies[static_cast<std::size_t>(body)].mass * mechanism.gravity.dot(centerOfMass(state, body));
  for (const SpringForce& spring : mechanism.springs) energy += actionOf(spring, state).potential;
  return energy;
}

bool isGain(double energy, double most) {
  return energy > most + kEnergyRounding * std::abs(most);
}

double limitEnergy(const MovedBodies& moved, double most, const Mechanism& mechanism, VectorX& state) {
  const double energy = energyOf(moved.bodies, mechanism, state);
  if (!isGain(energy, most)) return 0;
  const Vec3 kept = moved.isGrounded ? Vec3::Zero() : meanVelocity(moved.bodies, mechanism, state);
  for (const int body : moved.bodies) linearVelocity(state, body) -= kept;
  const double kinetic = kineticEnergyOf(moved.bodies, mechanism, state);
  const double part = kinetic > 0 ? std::sqrt(std::max(0.0, 1 - (energy - most) / kinetic)) : 0;
  for (const int body : moved.bodies) {
    state.segment<kVelocitySize>(velocityOffset(state, body)) *= part;
    linearVelocity(state, body) += kept;
  }
  return energy - energyOf(moved.bodies, mechanism, state);
}

}  // namespace cradle
