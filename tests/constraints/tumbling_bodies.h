#pragma once

#include <vector>

#include "dynamics/rigid_body.h"
#include "math/rotation.h"

namespace cradle {

/// Bodies without any symmetry, so that a wrong frame or sign shows; their states have nothing to do with each other.
struct TumblingBodies {
  std::vector<RigidBody> bodies;
  VectorX state;

  explicit TumblingBodies(int count) : state(VectorX::Zero(stateSize(count))) {
    for (int i = 0; i < count; ++i) {
      const Mat3 turn = rotationAbout(Vec3(1, i, 2), 0.3 + i).toRotationMatrix();
      bodies.push_back(makeRigidBody(
          {1 + 0.3 * i, Vec3::Zero(), turn * Vec3(0.1 + 0.02 * i, 0.2, 0.25).asDiagonal() * turn.transpose()}));
      centerOfMass(state, i) = Vec3(0.7 * i, 0.2 - i, 0.1 * i * i);
      setOrientation(state, i, rotationAbout(Vec3(i, -1, 0.5), 0.8 - i));
      linearVelocity(state, i) = Vec3(0.4, -1.1 + i, 0.2 * i);
      angularVelocity(state, i) = Vec3(1.3 - i, -0.6, 2.2);
    }
  }
};

}  // namespace cradle
