#pragma once

#include <array>
#include <vector>

#include "dynamics/state.h"
#include "mesh/mass_properties.h"

namespace cradle {

constexpr int kFixed = -1;  // in place of a moving body's index: something that does not move

/// What never changes about a moving body. All tensors about the centre of mass, in the body's frame.
struct RigidBody {
  double mass = 1;                         // kg
  double inverseMass = 1;                  // 1/kg
  Vec3 centerOfMass = Vec3::Zero();        // m, in the body's frame
  Mat3 inertiaTensor = Mat3::Identity();   // kg m^2
  Mat3 inverseInertia = Mat3::Identity();  // 1/(kg m^2)
  bool isSpherical = true;                 // the inertia tensor is a multiple of the identity
  bool hasConstantSpin = false;            // no torque ever acts; the state keeps the orientation of the start

  bool isDriven() const { return inverseMass == 0; }  // by no force: dynamics/driven_body.h
};

RigidBody makeRigidBody(const MassProperties& properties);

/// m: how far the mass of a body is from its centre, in the root of the mean square; 0 if no force moves it.
double gyrationRadius(const RigidBody& body);

/// A point fixed to a moving body, or to the world.
struct Attachment {
  int body = kFixed;
  Vec3 point = Vec3::Zero();  // m, from the centre of mass in the body's frame; world if fixed
};

/// Where an attachment is and how it moves.
struct AttachmentMotion {
  Vec3 arm;       // m, from the centre of mass, world; zero if fixed
  Vec3 position;  // m, world
  Vec3 velocity;  // m/s, world
};
AttachmentMotion motionOf(const Attachment& attachment, const VectorX& state);

/// What all forces on a body need of its orientation: found once an instant.
struct BodyFrame {
  std::array<double, 4> orientation = {};  // w, x, y, z as stored, that the others were found for
  Mat3 rotation;                           // worldFromBody
  Mat3 inverseInertia;                     // 1/(kg m^2), world
};

/// Those of all bodies. `frames` are none, or those of the same bodies in another state: what has not turned is kept.
void findBodyFrames(const std::vector<RigidBody>& bodies, const VectorX& state, std::vector<BodyFrame>& frames);

/// The same motion from bodies that were placed for `state`.
inline AttachmentMotion motionOf(const Attachment& attachment, const VectorX& state,
                                 const std::vector<BodyFrame>& frames) {
  const int body = attachment.body;
  if (body == kFixed) return {Vec3::Zero(), attachment.point, Vec3::Zero()};
  if (attachment.point == Vec3::Zero()) return {Vec3::Zero(), centerOfMass(state, body), linearVelocity(state, body)};
  const Vec3 arm = frames[static_cast<std::size_t>(body)].rotation * attachment.point;
  return {arm, centerOfMass(state, body) + arm,
          linearVelocity(state, body) + Vec3(angularVelocity(state, body)).cross(arm)};
}

/// Velocity (m/s, world) of a body's material point that is at `point` (m, world); zero if fixed.
inline Vec3 pointVelocity(int body, const Vec3& point, const VectorX& state) {
  if (body == kFixed) return Vec3::Zero();
  return linearVelocity(state, body) + angularVelocity(state, body).cross(point - centerOfMass(state, body));
}

/// Acceleration (m/s^2, world) of a body's material point that is at `point` (m, world), for the rates of all
/// velocities in `derivative`; zero if fixed.
Vec3 pointAcceleration(int body, const Vec3& point, const VectorX& state, const VectorX& derivative);

/// The inverse inertia tensor of a body in the world's frame.
Mat3 worldInverseInertia(const RigidBody& body, const Quat& worldFromBody);

/// Inverse mass (1/kg) that an attachment shows along a unit direction n (world): 1/m + (r x n)^T I^-1 (r x n); 0 if
/// fixed.
double inverseMassAlong(const Vec3& direction, const Attachment& attachment, const std::vector<RigidBody>& bodies,
                        const VectorX& state);

/// Adds to the velocities what an impulse (N s) at `arm` from the centre of mass (m), both world, gives. Nothing if
/// fixed.
void applyImpulse(const std::vector<RigidBody>& bodies, int body, const Vec3& arm, const Vec3& impulse, VectorX& state);

/// Turns a body by a rotation vector (rad, world; small or not) and keeps its orientation of unit length.
void turnBody(VectorX& state, Eigen::Index body, const Vec3& rotation);

/// Makes all orientations of unit length again.
void normalizeOrientations(VectorX& state);

}  // namespace cradle
