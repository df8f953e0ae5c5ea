#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "constraints/equations_of_motion.h"
#include "dynamics/integrators/dop853.h"
#include "dynamics/integrators/step_size.h"
#include "math/rotation.h"

// Bodies in contact, and their motion, for tests.

namespace cradle {

constexpr double kGravity = 9.81;          // m/s^2
constexpr double kMotionRounding = 1e-13;  // sums of a few accelerations of about 10, by forces a few times larger

constexpr auto kFrictionless = ContactMotion::frictionless;
constexpr auto kSliding = ContactMotion::sliding;
constexpr auto kSticking = ContactMotion::sticking;

inline RigidBody bodyOf(double mass, const Mat3& inertiaTensor) {
  return makeRigidBody({mass, Vec3::Zero(), inertiaTensor});
}
inline RigidBody solidSphere(double mass, double radius) {
  return bodyOf(mass, 0.4 * mass * radius * radius * Mat3::Identity());
}
/// A body without any symmetry, so that a wrong frame or sign shows.
inline RigidBody lopsided(double mass, const Quat& bodyFromPrincipal = rotationAbout(Vec3(1, 2, 3), 0.7)) {
  const Mat3 turn = bodyFromPrincipal.toRotationMatrix();
  const Mat3 tensor = mass * (turn * Vec3(0.02, 0.05, 0.06).asDiagonal() * turn.transpose());
  return bodyOf(mass, (tensor + tensor.transpose()) / 2);
}

inline Mechanism onEarth(std::vector<RigidBody> bodies) {
  Mechanism mechanism;
  mechanism.gravity = Vec3(0, -kGravity, 0);
  mechanism.bodies = std::move(bodies);
  return mechanism;
}

/// Gravity over a slope down along x, with y out of it.
constexpr double kSlope = std::numbers::pi / 6;
inline Vec3 tiltedGravity() {
  return kGravity * Vec3(std::sin(kSlope), -std::cos(kSlope), 0);
}

/// All bodies at the origin, straight and still.
inline VectorX restingState(std::size_t bodies) {
  const Eigen::Index count = static_cast<Eigen::Index>(bodies);
  VectorX state = VectorX::Zero(stateSize(count));
  for (Eigen::Index body = 0; body < count; ++body) setOrientation(state, body, Quat::Identity());
  return state;
}

/// A ball of body A on a flat face of body B; points in the bodies' frames.
inline ContactConstraint ballOnFace(const Attachment& center, double radius, const Attachment& face, const Vec3& normal,
                                    ContactMotion motion, double friction = 0, const Vec3& sliding = Vec3::UnitX()) {
  ContactConstraint contact;
  contact.centerA = center;
  contact.radiusA = radius;
  contact.surfaceB = face;
  contact.normalB = normal;
  contact.motion = motion;
  contact.friction = friction;
  contact.slidingDirection = sliding;
  return contact;
}
inline ContactConstraint sphereOnSphere(const Attachment& a, double radiusA, const Attachment& b, double radiusB,
                                        ContactMotion motion) {
  ContactConstraint contact = ballOnFace(a, radiusA, b, Vec3::UnitY(), motion);
  contact.radiusB = radiusB;
  return contact;
}

inline VectorX rateOf(const Mechanism& mechanism, const VectorX& state) {
  EquationsOfMotion equations(mechanism);
  VectorX rate;
  equations.evaluate(0, state, rate);
  return rate;
}

/// The state after `duration` by DOP853 with its own steps; nothing is projected.
inline VectorX integrated(const Mechanism& mechanism, VectorX state, double duration, double tolerance) {
  EquationsOfMotion equations(mechanism);
  const RightHandSide rightHandSide = equations.rightHandSide();
  const VectorX tolerances = VectorX::Constant(state.size(), tolerance);
  Step step;
  beginStep(rightHandSide, state, 0, duration, step);
  StepSize size{std::min(duration, firstTimeStep(rightHandSide, tolerances, step, 8))};
  double time = 0;
  while (time < duration) {
    const double taken = std::min(size.timeStep, duration - time);
    dop853(rightHandSide, state, time, taken, step);
    if (!acceptStep(dop853Error(step, tolerances), taken, size)) {
      keepStartDerivative(step);
      continue;
    }
    time = taken < duration - time ? time + taken : duration;
    state = step.state;
    normalizeOrientations(state);
  }
  return state;
}

inline ContactKinematics placeIn(const Mechanism& mechanism, std::size_t contact, const VectorX& state) {
  std::vector<BodyFrame> frames;
  findBodyFrames(mechanism.bodies, state, frames);
  return kinematicsOf(mechanism.contacts[contact], state, frames);
}

}  // namespace cradle
