#include "dynamics/free_flight.h"

namespace cradle {

FreeFlight::FreeFlight(const RigidBody& properties, const VectorX& state, Eigen::Index body, const Vec3& gravity)
    : body_(body),
      position_(centerOfMass(state, body)),
      velocity_(linearVelocity(state, body)),
      gravity_(gravity),
      rotation_(properties.inertiaTensor, {orientation(state, body), angularVelocity(state, body)}) {}

void FreeFlight::moveTo(double time, VectorX& state) const {
  centerOfMass(state, body_) = position_ + time * (velocity_ + time / 2 * gravity_);
  linearVelocity(state, body_) = velocity_ + time * gravity_;
  const RotationState turned = rotation_.at(time);
  setOrientation(state, body_, turned.worldFromBody);
  angularVelocity(state, body_) = turned.angularVelocity;
}

}  // namespace cradle
