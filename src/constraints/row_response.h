#pragma once

#include <vector>

#include "constraints/constraint_row.h"

namespace cradle {

/// M^-1 J^T of one row: the velocities that a multiplier of 1 gives to its bodies, in the world's frame.
struct RowResponse {
  Vec3 linearA = Vec3::Zero(), angularA = Vec3::Zero(), linearB = Vec3::Zero(), angularB = Vec3::Zero();
};

inline RowResponse responseTo(const ConstraintRow& row, const std::vector<RigidBody>& bodies,
                              const std::vector<BodyFrame>& frames) {
  RowResponse response;
  const auto respond = [&](int body, const Vec3& force, const Vec3& torque, Vec3& linear, Vec3& angular) {
    if (body == kFixed) return;
    const std::size_t index = static_cast<std::size_t>(body);
    linear = bodies[index].inverseMass * force;
    if (!bodies[index].hasConstantSpin) angular = frames[index].inverseInertia * torque;
  };
  respond(row.bodyA, row.linearA, row.angularA, response.linearA, response.angularA);
  respond(row.bodyB, row.linearB, row.angularB, response.linearB, response.angularB);
  return response;
}

/// An entry of the Delassus operator W = J M^-1 J^T: what `row` sees of the response to `other`.
inline double delassusEntry(const ConstraintRow& row, const ConstraintRow& other, const RowResponse& response) {
  double sum = 0;
  const auto add = [&](int body, const Vec3& linear, const Vec3& angular) {
    if (body == kFixed) return;
    if (body == row.bodyA) sum += linear.dot(row.linearA) + angular.dot(row.angularA);
    if (body == row.bodyB) sum += linear.dot(row.linearB) + angular.dot(row.angularB);
  };
  add(other.bodyA, response.linearA, response.angularA);
  add(other.bodyB, response.linearB, response.angularB);
  return sum;
}

/// Calls add(body, linear, angular) with what a multiplier of `row` gives to each of its bodies that moves.
template <class Add>
void addResponse(const ConstraintRow& row, const RowResponse& response, double multiplier, const Add& add) {
  if (row.bodyA != kFixed) add(row.bodyA, multiplier * response.linearA, multiplier * response.angularA);
  if (row.bodyB != kFixed) add(row.bodyB, multiplier * response.linearB, multiplier * response.angularB);
}

/// Adds to the velocities, or accelerations, in `state` what a multiplier of `row` gives.
inline void addResponse(const ConstraintRow& row, const RowResponse& response, double multiplier, VectorX& state) {
  addResponse(row, response, multiplier, [&state](int body, const Vec3& linear, const Vec3& angular) {
    linearVelocity(state, body) += linear;
    angularVelocity(state, body) += angular;
  });
}

}  // namespace cradle
