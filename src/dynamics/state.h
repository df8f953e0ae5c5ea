#pragma once

#include "math/types.h"

// The state of n moving bodies is one contiguous vector:
//   for each body  centre of mass x, y, z (m, world); orientation worldFromBody w, x, y, z
//   for each body  linear velocity x, y, z (m/s); angular velocity x, y, z (rad/s), both world frame
//   dissipated energy (J) and work of pushes (J) since the start
// Rates have the same layout.

namespace cradle {

constexpr Eigen::Index kPoseSize = 7;
constexpr Eigen::Index kVelocitySize = 6;
constexpr Eigen::Index kBalanceSize = 2;

inline Eigen::Index bodyCount(const VectorX& state) {
  return (state.size() - kBalanceSize) / (kPoseSize + kVelocitySize);
}
inline Eigen::Index stateSize(Eigen::Index bodies) {
  return bodies * (kPoseSize + kVelocitySize) + kBalanceSize;
}

/// Number of leading components that are positions: the rest are velocities and balances.
inline Eigen::Index poseComponents(const VectorX& state) {
  return bodyCount(state) * kPoseSize;
}
inline Eigen::Index velocityOffset(const VectorX& state, Eigen::Index body) {
  return poseComponents(state) + body * kVelocitySize;
}

template <class State>
auto centerOfMass(State& state, Eigen::Index body) {
  return state.template segment<3>(body * kPoseSize);
}
template <class State>
auto linearVelocity(State& state, Eigen::Index body) {
  return state.template segment<3>(velocityOffset(state, body));
}
template <class State>
auto angularVelocity(State& state, Eigen::Index body) {
  return state.template segment<3>(velocityOffset(state, body) + 3);
}

/// Orientation worldFromBody as stored: of unit length only up to the integrator's error.
inline Quat orientation(const VectorX& state, Eigen::Index body) {
  const Eigen::Index at = body * kPoseSize + 3;
  return {state[at], state[at + 1], state[at + 2], state[at + 3]};
}
inline void setOrientation(VectorX& state, Eigen::Index body, const Quat& worldFromBody) {
  state.segment<4>(body * kPoseSize + 3) << worldFromBody.w(), worldFromBody.x(), worldFromBody.y(), worldFromBody.z();
}

inline double& dissipatedEnergy(VectorX& state) {
  return state[state.size() - 2];
}
inline double dissipatedEnergy(const VectorX& state) {
  return state[state.size() - 2];
}
inline double& pushWork(VectorX& state) {
  return state[state.size() - 1];
}
inline double pushWork(const VectorX& state) {
  return state[state.size() - 1];
}

/// Tolerances for an ErrorNorm (integrators/step.h): one for orientations, one for all else.
inline VectorX stateTolerance(Eigen::Index bodies, double tolerance, double orientationTolerance) {
  VectorX tolerances = VectorX::Constant(stateSize(bodies), tolerance);
  for (Eigen::Index body = 0; body < bodies; ++body)
    tolerances.segment<4>(body * kPoseSize + 3).setConstant(orientationTolerance);
  return tolerances;
}

}  // namespace cradle
