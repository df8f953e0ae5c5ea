#pragma once

#include <cstddef>

#include "constraints/contact_motion.h"

// Bodies that stand on level ground by their corners.

namespace cradle {

inline double largestDifference(const VectorX& a, const VectorX& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

inline Mechanism manyOnEarth(std::size_t bodies) {
  Mechanism mechanism;
  mechanism.gravity = Vec3(1, -kGravity, -0.5);
  mechanism.bodies.assign(bodies, lopsided(2));
  return mechanism;
}

/// A corner of body `body` on level ground.
inline ContactConstraint corner(int body, const Vec3& point, ContactMotion motion) {
  return ballOnFace({body, point}, 0, {}, Vec3::UnitY(), motion, 0.3, Vec3(1, 0, 0.2));
}

/// `bodies` bodies one metre apart, with some velocities, each on three corners.
struct Row {
  Mechanism mechanism;
  VectorX state;

  explicit Row(int bodies)
      : mechanism(manyOnEarth(static_cast<std::size_t>(bodies))), state(restingState(mechanism.bodies.size())) {
    for (int body = 0; body < bodies; ++body) {
      centerOfMass(state, body) = Vec3(body, 0.2, 0);
      linearVelocity(state, body) = Vec3(0.3 + body, 0, 0.1);
      angularVelocity(state, body).y() = 0.2 * body;
      const ContactMotion motion = body % 2 == 0 ? kSliding : kFrictionless;
      for (const Vec3& point : {Vec3(0.2, -0.2, 0.1), Vec3(-0.2, -0.2, 0.1), Vec3(0.1, -0.2, -0.3)})
        mechanism.contacts.push_back(corner(body, point, motion));
    }
  }
};

}  // namespace cradle
