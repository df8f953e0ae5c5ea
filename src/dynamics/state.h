#pragma once

#include <limits>

#include "math/types.h"

// The state of n moving bodies is one contiguous vector:
//   for each body  centre of mass x, y, z (m, world); orientation worldFromBody w, x, y, z
//   for each body  linear velocity x, y, z (m/s); angular velocity x, y, z (rad/s), both world frame
//   energy ledger (J since the start): what impacts, friction and damping took, what numerical error took, and what
//   pushes gave. Friction, damping and work have rates; impacts and numerical error are booked as they happen.
// Rates have the same layout.

namespace cradle {

constexpr Eigen::Index kPoseSize = 7;
constexpr Eigen::Index kVelocitySize = 6;
constexpr Eigen::Index kLedgerSize = 5;

inline Eigen::Index bodyCount(const VectorX& state) {
  return (state.size() - kLedgerSize) / (kPoseSize + kVelocitySize);
}
inline Eigen::Index stateSize(Eigen::Index bodies) {
  return bodies * (kPoseSize + kVelocitySize) + kLedgerSize;
}

/// Number of leading components that are positions: the rest are velocities and the ledger.
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

/// By impacts of contacts and ropes: each takes something, whatever single contacts of it do.
inline double& impactEnergy(VectorX& state) {
  return state[state.size() - 5];
}
inline double impactEnergy(const VectorX& state) {
  return state[state.size() - 5];
}
/// By active contacts.
inline double& frictionEnergy(VectorX& state) {
  return state[state.size() - 4];
}
inline double frictionEnergy(const VectorX& state) {
  return state[state.size() - 4];
}
/// By springs' dampers.
inline double& dampingEnergy(VectorX& state) {
  return state[state.size() - 3];
}
inline double dampingEnergy(const VectorX& state) {
  return state[state.size() - 3];
}
/// Lost (> 0) or gained (< 0) by what no law asks for: errors of steps, projection, clamping, interpolation.
inline double& numericalEnergy(VectorX& state) {
  return state[state.size() - 2];
}
inline double numericalEnergy(const VectorX& state) {
  return state[state.size() - 2];
}
inline double& pushWork(VectorX& state) {
  return state[state.size() - 1];
}
inline double pushWork(const VectorX& state) {
  return state[state.size() - 1];
}

inline double dissipatedEnergy(const VectorX& state) {
  return impactEnergy(state) + frictionEnergy(state) + dampingEnergy(state);
}

/// Number of leading components that are the motion, without the ledger.
inline Eigen::Index motionComponents(const VectorX& state) {
  return state.size() - kLedgerSize;
}

/// Tolerances for an ErrorNorm (integrators/step.h): one for orientations, one for all else; none for the ledger, which
/// is to follow the steps that the motion needs.
inline VectorX stateTolerance(Eigen::Index bodies, double tolerance, double orientationTolerance) {
  VectorX tolerances = VectorX::Constant(stateSize(bodies), tolerance);
  for (Eigen::Index body = 0; body < bodies; ++body)
    tolerances.segment<4>(body * kPoseSize + 3).setConstant(orientationTolerance);
  tolerances.tail<kLedgerSize>().setConstant(std::numeric_limits<double>::infinity());
  return tolerances;
}

}  // namespace cradle
