#include "impact/contact_impulse.h"

#include "math/rotation.h"

namespace cradle {
namespace {

// Of the inverse mass without ties, which take part to 1e-16: the square of a lever, in sizes of a body.
constexpr double kImmobileRatio = 1e-12;

Vec3 armOf(const Contact& contact, int body, const VectorX& state) {
  return body == kFixed ? Vec3::Zero() : Vec3(contact.point - centerOfMass(state, body));
}

Mat3 inverseMassOf(const Contact& contact, int body, const std::vector<RigidBody>& bodies, const VectorX& state) {
  if (body == kFixed) return Mat3::Zero();
  const RigidBody& inertia = bodies[static_cast<std::size_t>(body)];
  const Mat3 lever = skew(armOf(contact, body, state));
  return inertia.inverseMass * Mat3::Identity() -
         lever * worldInverseInertia(inertia, orientation(state, body)) * lever;
}

/// 1/kg.
double inverseMassAlongNormal(const Contact& contact, const ImpulseResponse& response, const VectorX& state) {
  const VectorX answer = response.answerTo(contact, contact.normal, state);
  return contact.normal.dot(relativeVelocity(contact, state, answer));
}

double untiedInverseMassAlongNormal(const Contact& contact, const ImpulseResponse& response, const VectorX& state) {
  return contact.normal.dot(response.untiedInverseMassAt(contact, state) * contact.normal);
}

}  // namespace

Mat3 inverseMassAt(const Contact& contact, const std::vector<RigidBody>& bodies, const VectorX& state) {
  return inverseMassOf(contact, contact.bodyA, bodies, state) + inverseMassOf(contact, contact.bodyB, bodies, state);
}

bool isImmobile(const Contact& contact, const ImpulseResponse& response, const VectorX& state, double inverseMass) {
  return response.areTied() && inverseMass <= kImmobileRatio * untiedInverseMassAlongNormal(contact, response, state);
}

bool hasShortLever(const Contact& contact, const ImpulseResponse& response, const VectorX& state, double lever) {
  return response.areTied() && inverseMassAlongNormal(contact, response, state) <=
                                   lever * lever * untiedInverseMassAlongNormal(contact, response, state);
}

void eraseImmobile(const ImpulseResponse& response, const VectorX& state, std::vector<Contact>& contacts) {
  if (!response.areTied()) return;
  std::erase_if(contacts, [&](const Contact& contact) {
    return isImmobile(contact, response, state, inverseMassAlongNormal(contact, response, state));
  });
}

Mat3 ImpulseResponse::inverseMassAt(const Contact& contact, const VectorX& state) const {
  if (!constraints_) return untiedInverseMassAt(contact, state);
  Mat3 inverseMass;
  for (int i = 0; i < 3; ++i) inverseMass.col(i) = relativeVelocity(contact, answerTo(contact, Vec3::Unit(i), state));
  return inverseMass;
}

VectorX ImpulseResponse::answerTo(const Contact& contact, const Vec3& impulseOnB, const VectorX& state) const {
  VectorX answer = state;
  answer.tail(state.size() - poseComponents(state)).setZero();
  apply(contact, impulseOnB, answer);
  return answer;
}

Mat3 ImpulseResponse::untiedInverseMassAt(const Contact& contact, const VectorX& state) const {
  return cradle::inverseMassAt(contact, bodies_, state);
}

void ImpulseResponse::apply(const Contact& contact, const Vec3& impulseOnB, VectorX& state) const {
  applyImpulse(bodies_, contact.bodyA, armOf(contact, contact.bodyA, state), -impulseOnB, state);
  applyImpulse(bodies_, contact.bodyB, armOf(contact, contact.bodyB, state), impulseOnB, state);
  if (constraints_) constraints_->constrainVelocities(state);
}

}  // namespace cradle
