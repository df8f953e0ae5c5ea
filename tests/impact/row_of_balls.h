#pragma once

#include <vector>

#include "impact/pairwise.h"

namespace cradle {

inline VectorX statesAtRest(Eigen::Index bodies) {
  VectorX state = VectorX::Zero(stateSize(bodies));
  for (Eigen::Index body = 0; body < bodies; ++body) setOrientation(state, body, Quat::Identity());
  return state;
}

inline RigidBody ball(double mass) {
  return makeRigidBody({mass, Vec3::Zero(), 0.4 * mass * 0.01 * Mat3::Identity()});
}

/// Balls of radius 0.1 in a row along x, touching.
struct RowOfBalls {
  std::vector<RigidBody> bodies;
  VectorX state;
  std::vector<ImpactContact> impacts;

  RowOfBalls(const std::vector<double>& masses, double restitution) : state(statesAtRest(std::ssize(masses))) {
    for (std::size_t i = 0; i < masses.size(); ++i) {
      bodies.push_back(ball(masses[i]));
      centerOfMass(state, static_cast<Eigen::Index>(i)).x() = 0.2 * static_cast<double>(i);
      if (i == 0) continue;
      const int b = static_cast<int>(i);
      const Contact contact{i - 1, b - 1, b, Vec3(0.2 * b - 0.1, 0, 0), Vec3::UnitX(), 0};
      impacts.push_back({contact, {restitution, 0, 0}, 0, Vec3::Zero()});
    }
  }

  void setSpeeds(const std::vector<double>& speeds) {
    for (std::size_t i = 0; i < speeds.size(); ++i) linearVelocity(state, static_cast<Eigen::Index>(i)).x() = speeds[i];
  }
  double speed(int body) const { return linearVelocity(state, body).x(); }
  std::vector<double> speeds() const {
    std::vector<double> all;
    for (int body = 0; body < std::ssize(bodies); ++body) all.push_back(speed(body));
    return all;
  }
};

}  // namespace cradle
