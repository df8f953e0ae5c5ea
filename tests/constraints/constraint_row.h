#pragma once

#include <vector>

#include "constraints/constraint.h"

// Rows one by one, with a part for each body's velocities: what blocks are held against.

namespace cradle {

/// A row of a constraint C(positions) = 0: dC/dt = J v.
struct ConstraintRow {
  int bodyA = kFixed, bodyB = kFixed;
  Vec3 linearA, angularA, linearB, angularB;  // the Jacobian J, in parts; world frame
  double value = 0;                           // C, the constraint error
  double velocityProduct = 0;                 // (dJ/dt) v
  double scale = 1;                           // C / scale is the error in m, or rad
  double rounding = 0;                        // m, or rad
};

inline ConstraintRow rowOf(const ConstraintBlock& block, int row) {
  const Vec3 linear = block.linear.row(row);
  const std::size_t i = static_cast<std::size_t>(row);
  return {block.bodyA,    block.bodyB,
          linear,         block.turnsA ? Vec3(block.angularA.row(row)) : Vec3::Zero(),
          -linear,        block.turnsB ? Vec3(block.angularB.row(row)) : Vec3::Zero(),
          block.value[i], block.velocityProduct[i],
          block.scale,    block.rounding[i]};
}

/// The rows of all constraints in their order.
inline std::vector<ConstraintRow> rowsOf(const Constraints& constraints, const VectorX& state,
                                         const std::vector<BodyFrame>& frames) {
  std::vector<ConstraintRow> rows;
  ConstraintBlock block;
  for (const Constraint& constraint : constraints) {
    findRows(constraint, state, frames, block);
    for (int i = 0; i < block.rows; ++i) rows.push_back(rowOf(block, i));
  }
  return rows;
}

/// J v for the velocities, or accelerations, in `state`.
inline double rateOf(const ConstraintRow& row, const VectorX& state) {
  double rate = 0;
  if (row.bodyA != kFixed)
    rate += row.linearA.dot(linearVelocity(state, row.bodyA)) + row.angularA.dot(angularVelocity(state, row.bodyA));
  if (row.bodyB != kFixed)
    rate += row.linearB.dot(linearVelocity(state, row.bodyB)) + row.angularB.dot(angularVelocity(state, row.bodyB));
  return rate;
}

/// M^-1 J^T of a row: a state without poses that moves as a multiplier of 1 asks.
inline VectorX responseTo(const ConstraintRow& row, const std::vector<RigidBody>& bodies,
                          const std::vector<BodyFrame>& frames) {
  VectorX response = VectorX::Zero(stateSize(std::ssize(bodies)));
  const auto add = [&](int body, const Vec3& linear, const Vec3& angular) {
    if (body == kFixed) return;
    const std::size_t at = static_cast<std::size_t>(body);
    linearVelocity(response, body) += bodies[at].inverseMass * linear;
    angularVelocity(response, body) += frames[at].inverseInertia * angular;
  };
  add(row.bodyA, row.linearA, row.angularA);
  add(row.bodyB, row.linearB, row.angularB);
  return response;
}

}  // namespace cradle
