#include "simulate/steps/contact_energy.h"

#include <Eigen/Cholesky>
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

/// The motion of bodies as if they were one rigid body with the same momenta: what it has of kinetic energy, relative
/// motions add to (J. Koenig's theorem, for the angular momentum too).
struct RigidMotion {
  double mass = 0;                                                           // kg
  Vec3 center = Vec3::Zero();                                                // m
  Vec3 velocity = Vec3::Zero();                                              // m/s
  Vec3 angularMomentum = Vec3::Zero();                                       // kg m^2/s, about the centre
  Mat3 inertiaTensor = Mat3::Zero();                                         // kg m^2, about the centre, world
  Vec3 spin() const { return inertiaTensor.ldlt().solve(angularMomentum); }  // rad/s
};

RigidMotion rigidMotionOf(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state) {
  RigidMotion motion;
  for (const int body : bodies) {
    const double mass = mechanism.bodies[static_cast<std::size_t>(body)].mass;
    motion.mass += mass;
    motion.center += mass * centerOfMass(state, body);
    motion.velocity += mass * linearVelocity(state, body);
  }
  motion.center /= motion.mass, motion.velocity /= motion.mass;
  for (const int body : bodies) {
    const RigidBody& inertia = mechanism.bodies[static_cast<std::size_t>(body)];
    const Vec3 arm = centerOfMass(state, body) - motion.center;
    const Mat3 rotation = orientation(state, body).normalized().toRotationMatrix();
    const Mat3 own = rotation * inertia.inertiaTensor * rotation.transpose();
    motion.inertiaTensor += own + inertia.mass * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    motion.angularMomentum += own * Vec3(angularVelocity(state, body)) +
                              inertia.mass * arm.cross(linearVelocity(state, body) - motion.velocity);
  }
  return motion;
}

/// Adds velocities of bodies that move as one.
void addRigidMotion(const std::vector<int>& bodies, const Vec3& center, const Vec3& velocity, const Vec3& spin,
                    VectorX& state) {
  for (const int body : bodies) {
    linearVelocity(state, body) += velocity + spin.cross(centerOfMass(state, body) - center);
    angularVelocity(state, body) += spin;
  }
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
  const RigidMotion kept = moved.isGrounded ? RigidMotion() : rigidMotionOf(moved.bodies, mechanism, state);
  const Vec3 spin = moved.isGrounded ? Vec3::Zero() : kept.spin();
  addRigidMotion(moved.bodies, kept.center, -kept.velocity, -spin, state);
  const double kinetic = kineticEnergyOf(moved.bodies, mechanism, state);
  const double part = kinetic > 0 ? std::sqrt(std::max(0.0, 1 - (energy - most) / kinetic)) : 0;
  for (const int body : moved.bodies) state.segment<kVelocitySize>(velocityOffset(state, body)) *= part;
  addRigidMotion(moved.bodies, kept.center, kept.velocity, spin, state);
  return energy - energyOf(moved.bodies, mechanism, state);
}

void keepMomenta(const MovedBodies& moved, const VectorX& free, const Mechanism& mechanism, VectorX& state) {
  if (moved.isGrounded) return;
  const RigidMotion before = rigidMotionOf(moved.bodies, mechanism, free);
  const Vec3 shift = before.center - rigidMotionOf(moved.bodies, mechanism, state).center;
  for (const int body : moved.bodies) centerOfMass(state, body) += shift;
  RigidMotion missing = rigidMotionOf(moved.bodies, mechanism, state);
  missing.angularMomentum = before.angularMomentum - missing.angularMomentum;
  addRigidMotion(moved.bodies, missing.center, before.velocity - missing.velocity, missing.spin(), state);
}

}  // namespace cradle
