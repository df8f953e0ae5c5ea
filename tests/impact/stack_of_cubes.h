#pragma once

#include <vector>

#include "impact/row_of_balls.h"
#include "math/rotation.h"

namespace cradle {

/// Cubes of edge 1 on each other on a floor at y = 0, turned by 0.3 rad one against the other.
struct StackOfCubes {
  std::vector<RigidBody> bodies;
  std::vector<Contact> contacts;
  VectorX state;

  explicit StackOfCubes(const std::vector<double>& masses) : state(statesAtRest(std::ssize(masses))) {
    for (int body = 0; body < std::ssize(masses); ++body) {
      const double mass = masses[static_cast<std::size_t>(body)];
      bodies.push_back(makeRigidBody({mass, Vec3::Zero(), Mat3(mass / 12 * Vec3(2, 2.2, 1.9).asDiagonal())}));
      centerOfMass(state, body).y() = 0.5 + body;
      setOrientation(state, body, rotationAbout(Vec3(1, 2, 3), 0.3 * body));
      for (const double x : {-0.5, 0.45})
        for (const double z : {-0.4, 0.5}) contacts.push_back({0, body, body - 1, Vec3(x, body, z), -Vec3::UnitY(), 0});
    }
  }
};

}  // namespace cradle
