#include "dynamics/rigid_body.h"

#include <cmath>

#include <Eigen/LU>
#include <algorithm>

#include "math/rotation.h"

namespace cradle {

RigidBody makeRigidBody(const MassProperties& properties) {
  const Mat3& tensor = properties.inertiaTensor;
  const bool isSpherical = tensor == tensor(0, 0) * Mat3::Identity();
  const Mat3 inverse = isSpherical ? Mat3(1 / tensor(0, 0) * Mat3::Identity()) : Mat3(tensor.inverse());
  return {properties.mass, 1 / properties.mass, properties.centerOfMass, tensor, inverse, isSpherical, false};
}

double gyrationRadius(const RigidBody& body) {
  return body.isDriven() ? 0 : std::sqrt(body.inertiaTensor.trace() / (2 * body.mass));
}

AttachmentMotion motionOf(const Attachment& attachment, const VectorX& state) {
  if (attachment.body == kFixed) return {Vec3::Zero(), attachment.point, Vec3::Zero()};
  const Vec3 arm = orientation(state, attachment.body).normalized() * attachment.point;
  return {arm, centerOfMass(state, attachment.body) + arm,
          linearVelocity(state, attachment.body) + angularVelocity(state, attachment.body).cross(arm)};
}

void findBodyFrames(const std::vector<RigidBody>& bodies, const VectorX& state, std::vector<BodyFrame>& frames) {
  frames.resize(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    BodyFrame& frame = frames[i];
    const double* stored = state.data() + i * kPoseSize + 3;
    if (std::equal(frame.orientation.begin(), frame.orientation.end(), stored)) continue;
    std::copy_n(stored, frame.orientation.size(), frame.orientation.begin());
    frame.inverseInertia = bodies[i].inverseInertia;
    if (bodies[i].hasConstantSpin) {
      frame.rotation.setIdentity();  // nothing is attached off its centre
      continue;
    }
    frame.rotation = orientation(state, static_cast<Eigen::Index>(i)).normalized().toRotationMatrix();
    if (!bodies[i].isSpherical)
      frame.inverseInertia = frame.rotation * bodies[i].inverseInertia * frame.rotation.transpose();
  }
}

Vec3 pointAcceleration(int body, const Vec3& point, const VectorX& state, const VectorX& derivative) {
  if (body == kFixed) return Vec3::Zero();
  const Vec3 arm = point - centerOfMass(state, body), spin = angularVelocity(state, body);
  return linearVelocity(derivative, body) + angularVelocity(derivative, body).cross(arm) + spin.cross(spin.cross(arm));
}

Mat3 worldInverseInertia(const RigidBody& body, const Quat& worldFromBody) {
  const Mat3 rotation = worldFromBody.normalized().toRotationMatrix();
  return rotation * body.inverseInertia * rotation.transpose();
}

double inverseMassAlong(const Vec3& direction, const Attachment& attachment, const std::vector<RigidBody>& bodies,
                        const VectorX& state) {
  if (attachment.body == kFixed) return 0;
  const RigidBody& body = bodies[static_cast<std::size_t>(attachment.body)];
  const Vec3 lever = motionOf(attachment, state).arm.cross(direction);
  return body.inverseMass + lever.dot(worldInverseInertia(body, orientation(state, attachment.body)) * lever);
}

void applyImpulse(const std::vector<RigidBody>& bodies, int body, const Vec3& arm, const Vec3& impulse,
                  VectorX& state) {
  if (body == kFixed) return;
  const RigidBody& inertia = bodies[static_cast<std::size_t>(body)];
  linearVelocity(state, body) += inertia.inverseMass * impulse;
  angularVelocity(state, body) += worldInverseInertia(inertia, orientation(state, body)) * arm.cross(impulse);
}

void turnBody(VectorX& state, Eigen::Index body, const Vec3& rotation) {
  const double angle = rotation.norm();
  if (angle == 0) return;
  setOrientation(state, body, (rotationAbout(rotation, angle) * orientation(state, body)).normalized());
}

void normalizeOrientations(VectorX& state) {
  for (Eigen::Index body = 0; body < bodyCount(state); ++body)
    setOrientation(state, body, orientation(state, body).normalized());
}

}  // namespace cradle
