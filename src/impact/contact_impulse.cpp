#include "impact/contact_impulse.h"

#include "math/rotation.h"

namespace cradle {
namespace {

Vec3 armOf(const Contact& contact, int body, const VectorX& state) {
  return body == kFixed ? Vec3::Zero() : Vec3(contact.point - centerOfMass(state, body));
}

Vec3 pointVelocity(const Contact& contact, int body, const VectorX& places, const VectorX& velocities) {
  if (body == kFixed) return Vec3::Zero();
  return linearVelocity(velocities, body) + angularVelocity(velocities, body).cross(armOf(contact, body, places));
}

Mat3 inverseMassOf(const Contact& contact, int body, const std::vector<RigidBody>& bodies, const VectorX& state) {
  if (body == kFixed) return Mat3::Zero();
  const RigidBody& inertia = bodies[static_cast<std::size_t>(body)];
  const Mat3 lever = skew(armOf(contact, body, state));
  return inertia.inverseMass * Mat3::Identity() -
         lever * worldInverseInertia(inertia, orientation(state, body)) * lever;
}

}  // namespace

Vec3 relativeVelocity(const Contact& contact, const VectorX& state) {
  return relativeVelocity(contact, state, state);
}

Vec3 relativeVelocity(const Contact& contact, const VectorX& places, const VectorX& velocities) {
  return pointVelocity(contact, contact.bodyB, places, velocities) -
         pointVelocity(contact, contact.bodyA, places, velocities);
}

Mat3 inverseMassAt(const Contact& contact, const std::vector<RigidBody>& bodies, const VectorX& state) {
  return inverseMassOf(contact, contact.bodyA, bodies, state) + inverseMassOf(contact, contact.bodyB, bodies, state);
}

void applyContactImpulse(const Contact& contact, const Vec3& impulseOnB, const std::vector<RigidBody>& bodies,
                         VectorX& state) {
  applyImpulse(bodies, contact.bodyA, armOf(contact, contact.bodyA, state), -impulseOnB, state);
  applyImpulse(bodies, contact.bodyB, armOf(contact, contact.bodyB, state), impulseOnB, state);
}

}  // namespace cradle
