#include "impact/contact_impulse.h"

#include <utility>

#include "math/rotation.h"

namespace cradle {
namespace {

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
  const VectorX answer = response.responseTo(contact, contact.normal, state);
  return contact.normal.dot(relativeVelocity(contact, state, answer));
}

double unconstrainedDelassusAlongNormal(const Contact& contact, const ImpulseResponse& response, const VectorX& state) {
  return contact.normal.dot(response.unconstrainedDelassusAt(contact, state) * contact.normal);
}

}  // namespace

Mat3 delassusAt(const Contact& contact, const std::vector<RigidBody>& bodies, const VectorX& state) {
  return inverseMassOf(contact, contact.bodyA, bodies, state) + inverseMassOf(contact, contact.bodyB, bodies, state);
}

ConstraintBlock rowsAlong(const Eigen::Ref<const Eigen::Matrix<double, 3, Eigen::Dynamic>>& directions,
                          const Contact& contact, const VectorX& state) {
  const Vec3 armA = armOf(contact, contact.bodyA, state), armB = armOf(contact, contact.bodyB, state);
  ConstraintBlock block;
  block.bodyA = contact.bodyA, block.bodyB = contact.bodyB;
  block.turnsA = contact.bodyA != kFixed, block.turnsB = contact.bodyB != kFixed;
  block.rows = static_cast<int>(directions.cols());
  for (int row = 0; row < block.rows; ++row) {
    const Vec3 direction = directions.col(row);
    block.linear.row(row) = -direction;
    block.angularA.row(row) = -armA.cross(direction), block.angularB.row(row) = armB.cross(direction);
  }
  return block;
}

bool hasShortMomentArm(const Contact& contact, const ImpulseResponse& response, const VectorX& state, double arm) {
  return response.areConstrained() && inverseMassAlongNormal(contact, response, state) <=
                                          arm * arm * unconstrainedDelassusAlongNormal(contact, response, state);
}

bool isImmobile(const Contact& contact, const ImpulseResponse& response, const VectorX& state) {
  return response.areConstrained() && isImmobile(inverseMassAlongNormal(contact, response, state),
                                                 unconstrainedDelassusAlongNormal(contact, response, state));
}

void eraseImmobile(const ImpulseResponse& response, const VectorX& state, std::vector<Contact>& contacts) {
  std::erase_if(contacts, [&](const Contact& contact) { return isImmobile(contact, response, state); });
}

Mat3 ImpulseResponse::delassusAt(const Contact& contact, const VectorX& state) const {
  if (!constraints_) return unconstrainedDelassusAt(contact, state);
  Mat3 inverseMass;
  for (int i = 0; i < 3; ++i) inverseMass.col(i) = relativeVelocity(contact, responseTo(contact, Vec3::Unit(i), state));
  return inverseMass;
}

VectorX ImpulseResponse::responseTo(const Contact& contact, const Vec3& impulseOnB, const VectorX& state) const {
  VectorX answer = state;
  answer.tail(state.size() - poseComponents(state)).setZero();
  apply(contact, impulseOnB, answer);
  return answer;
}

Mat3 ImpulseResponse::unconstrainedDelassusAt(const Contact& contact, const VectorX& state) const {
  return cradle::delassusAt(contact, bodies_, state);
}

DenseDelassus ImpulseResponse::delassusOf(std::vector<ConstraintBlock> blocks, const VectorX& state) const {
  std::vector<BodyFrame> frames;
  findBodyFrames(bodies_, state, frames);
  return {std::move(blocks), bodies_, frames, constraints_};
}

void ImpulseResponse::apply(const Contact& contact, const Vec3& impulseOnB, VectorX& state) const {
  applyImpulse(bodies_, contact.bodyA, armOf(contact, contact.bodyA, state), -impulseOnB, state);
  applyImpulse(bodies_, contact.bodyB, armOf(contact, contact.bodyB, state), impulseOnB, state);
  if (constraints_) constraints_->constrainVelocities(state);
}

}  // namespace cradle
