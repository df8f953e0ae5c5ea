#include "dynamics/driven_body.h"

#include <algorithm>
#include <limits>

namespace cradle {

RigidBody drivenRigidBody() {
  RigidBody body;
  body.mass = 0, body.inverseMass = 0;
  body.inertiaTensor.setZero(), body.inverseInertia.setZero();
  return body;
}

void add(int body, const PrescribedMotion& motion, std::vector<DrivenBody>& driven) {
  driven.emplace_back();
  driven.back().body = body, driven.back().motion = motion;
}

void place(const std::vector<DrivenBody>& driven, double time, VectorX& state) {
  for (const DrivenBody& one : driven) {
    const PoseMotion now = motionAt(one.motion, time);
    centerOfMass(state, one.body) = now.pose.translation;
    // A quaternion and its negative are one orientation: the one that the state has come to.
    const double side = orientation(state, one.body).dot(now.pose.rotation) < 0 ? -1 : 1;
    setOrientation(state, one.body, Quat(side * now.pose.rotation.coeffs()));
    linearVelocity(state, one.body) = now.velocity;
    angularVelocity(state, one.body) = now.angularVelocity;
  }
}

void accelerate(const std::vector<DrivenBody>& driven, double time, VectorX& derivative) {
  for (const DrivenBody& one : driven) {
    const PoseMotion now = motionAt(one.motion, time);
    linearVelocity(derivative, one.body) = now.acceleration;
    angularVelocity(derivative, one.body) = now.angularAcceleration;
  }
}

double powerOfDriven(const std::vector<RigidBody>& bodies, int body, const Vec3& point, const Vec3& force,
                     const VectorX& state) {
  if (body == kFixed || !bodies[static_cast<std::size_t>(body)].isDriven()) return 0;
  return force.dot(pointVelocity(body, point, state));
}

bool isDrivenStill(const std::vector<DrivenBody>& driven, int body, double time) {
  const auto found =
      std::find_if(driven.begin(), driven.end(), [body](const DrivenBody& one) { return one.body == body; });
  return found != driven.end() && isStill(found->motion, time);
}

double nextJump(const std::vector<DrivenBody>& driven, double time) {
  double next = std::numeric_limits<double>::infinity();
  for (const DrivenBody& one : driven) next = std::min(next, nextJump(one.motion, time));
  return next;
}

}  // namespace cradle
