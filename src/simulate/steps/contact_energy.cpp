#include "simulate/steps/contact_energy.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace cradle {
namespace {

double kineticEnergyOf(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state) {
  double energy = 0;
  for (const int body : bodies) energy += kineticEnergy(mechanism.bodies[static_cast<std::size_t>(body)], body, state);
  return energy;
}

using Vec6 = Eigen::Vector<double, 6>;

/// Bodies as one rigid body. Kinetic energy and angular momentum are those of the common motion plus those of the
/// motion relative to it (J. Koenig).
struct WholeOfBodies {
  double mass = 0;                    // kg
  Vec3 center = Vec3::Zero();         // m
  Vec6 momenta = Vec6::Zero();        // kg m/s; kg m^2/s about the centre
  Mat3 inertiaTensor = Mat3::Zero();  // kg m^2, about the centre, world

  /// The motion among `motions` that has the momenta of these.
  Vec6 motionAmong(const RigidMotions& motions) const {
    RigidMotions momentaOf = motions;
    momentaOf.topRows<3>() *= mass;
    momentaOf.bottomRows<3>() = inertiaTensor * motions.bottomRows<3>();
    if (motions.cols() == 0) return Vec6::Zero();
    return motions * (motions.transpose() * momentaOf).ldlt().solve(motions.transpose() * momenta);
  }
};

WholeOfBodies wholeOf(const std::vector<int>& bodies, const Mechanism& mechanism, const VectorX& state) {
  WholeOfBodies whole;
  Vec3 momentum = Vec3::Zero(), angularMomentum = Vec3::Zero();
  for (const int body : bodies) {
    const double mass = mechanism.bodies[static_cast<std::size_t>(body)].mass;
    whole.mass += mass;
    whole.center += mass * centerOfMass(state, body);
    momentum += mass * linearVelocity(state, body);
  }
  whole.center /= whole.mass;
  for (const int body : bodies) {
    const RigidBody& inertia = mechanism.bodies[static_cast<std::size_t>(body)];
    const Vec3 momentArm = centerOfMass(state, body) - whole.center;
    const Mat3 rotation = orientation(state, body).normalized().toRotationMatrix();
    const Mat3 own = rotation * inertia.inertiaTensor * rotation.transpose();
    whole.inertiaTensor +=
        own + inertia.mass * (momentArm.squaredNorm() * Mat3::Identity() - momentArm * momentArm.transpose());
    angularMomentum += own * Vec3(angularVelocity(state, body)) +
                       inertia.mass * momentArm.cross(linearVelocity(state, body) - momentum / whole.mass);
  }
  whole.momenta << momentum, angularMomentum;
  return whole;
}

/// Adds a common rigid motion about `center` to the velocities of bodies.
void addMotion(const std::vector<int>& bodies, const Vec3& center, const Vec6& motion, VectorX& state) {
  const Vec3 commonRotation = motion.tail<3>();
  for (const int body : bodies) {
    linearVelocity(state, body) += motion.head<3>() + commonRotation.cross(centerOfMass(state, body) - center);
    angularVelocity(state, body) += commonRotation;
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
  return energy > most + StepTolerances::kEnergyRounding * std::abs(most);
}

void hinderByPlane(const Vec3& normal, RigidMotions& kept) {
  const bool isHinderedSo =
      kept.cols() == 3 && kept.col(2).tail<3>().cross(normal).isZero(StepTolerances::kParallelNormals);
  if (isHinderedSo) return;
  const bool isFree = kept.cols() == 6;
  kept.setZero(6, isFree ? 3 : 0);
  if (!isFree) return;
  kept.col(0).head<3>() = normal.unitOrthogonal();
  kept.col(1).head<3>() = normal.cross(kept.col(0).head<3>());
  kept.col(2).tail<3>() = normal;
}

double clampEnergy(const MovedBodies& moved, double most, const Mechanism& mechanism, VectorX& state) {
  const double energy = energyOf(moved.bodies, mechanism, state);
  if (!isGain(energy, most)) return 0;
  const WholeOfBodies whole = wholeOf(moved.bodies, mechanism, state);
  const Vec6 kept = whole.motionAmong(moved.kept);
  addMotion(moved.bodies, whole.center, -kept, state);
  const double kinetic = kineticEnergyOf(moved.bodies, mechanism, state);
  const double part = kinetic > 0 ? std::sqrt(std::max(0.0, 1 - (energy - most) / kinetic)) : 0;
  for (const int body : moved.bodies) state.segment<kVelocitySize>(velocityOffset(state, body)) *= part;
  addMotion(moved.bodies, whole.center, kept, state);
  return energy - energyOf(moved.bodies, mechanism, state);
}

void keepMomenta(const MovedBodies& moved, const VectorX& free, const Mechanism& mechanism, VectorX& state) {
  if (moved.kept.cols() == 0) return;
  const WholeOfBodies before = wholeOf(moved.bodies, mechanism, free);
  const auto shifts = moved.kept.topRows<3>();
  const Vec3 missing = before.center - wholeOf(moved.bodies, mechanism, state).center;
  for (const int body : moved.bodies) centerOfMass(state, body) += shifts * (shifts.transpose() * missing);
  WholeOfBodies whole = wholeOf(moved.bodies, mechanism, state);
  whole.momenta = before.momenta - whole.momenta;
  addMotion(moved.bodies, whole.center, whole.motionAmong(moved.kept), state);
}

}  // namespace cradle
