#pragma once

#include <vector>

#include "constraints/constraint_block.h"

namespace cradle {

/// M^-1 J^T of a block: what multipliers of its rows give to its bodies.
struct BlockResponse {
  double inverseMassA = 0, inverseMassB = 0;  // 1/kg; 0 if fixed
  ConstraintBlock::Jacobian turnA, turnB;     // angularA I^-1, angularB I^-1; not set where these are zero
};
/// A row times a vector. Loops over the rows become loops over neighbours in memory, two at a time.
template <class Vector>
[[gnu::always_inline]] inline double dotOf(const ConstraintBlock::Jacobian& jacobian, int row, const Vector& vector) {
  return jacobian(row, 0) * vector[0] + jacobian(row, 1) * vector[1] + jacobian(row, 2) * vector[2];
}

inline void findResponse(const ConstraintBlock& block, const std::vector<RigidBody>& bodies,
                         const std::vector<BodyFrame>& frames, BlockResponse& response) {
  const auto inverseMassOf = [&bodies](int body) {
    return body == kFixed ? 0 : bodies[static_cast<std::size_t>(body)].inverseMass;
  };
  response.inverseMassA = inverseMassOf(block.bodyA), response.inverseMassB = inverseMassOf(block.bodyB);
  const auto findTurn = [&](int body, const ConstraintBlock::Jacobian& angular, ConstraintBlock::Jacobian& turn) {
    const std::size_t index = static_cast<std::size_t>(body);
    const Mat3 inverseInertia = bodies[index].hasConstantSpin ? Mat3::Zero() : frames[index].inverseInertia;
    withRows(block.rows, [&](auto rows) {
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < rows; ++i) turn(i, k) = dotOf(angular, i, inverseInertia.col(k));
    });
  };
  if (block.turnsA) findTurn(block.bodyA, block.angularA, response.turnA);
  if (block.turnsB) findTurn(block.bodyB, block.angularB, response.turnB);
}

/// Which bodies two blocks have in common: the first one's A or B is the second one's A or B.
struct SharedBodies {
  bool aa = false, ab = false, ba = false, bb = false;
  bool any() const { return aa || ab || ba || bb; }
};
inline SharedBodies sharedBodies(const ConstraintBlock& row, const ConstraintBlock& column) {
  const auto isShared = [](int body, int other) { return body != kFixed && body == other; };
  return {isShared(row.bodyA, column.bodyA), isShared(row.bodyA, column.bodyB), isShared(row.bodyB, column.bodyA),
          isShared(row.bodyB, column.bodyB)};
}

/// Parts of J M^-1 J^T of two blocks, column by column and `stride` apart: what a mass does, and what turning adds.
template <int rows, int columns>
[[gnu::always_inline]] inline void putMass(const ConstraintBlock& row, const ConstraintBlock& column,
                                           double inverseMass, double* __restrict__ entries, int stride) {
  const bool arePoints = row.isPoint && column.isPoint;
  for (int k = 0; k < columns; ++k)
    for (int i = 0; i < rows; ++i)
      entries[k * stride + i] =
          arePoints ? (i == k && i < 3 ? inverseMass : 0) : inverseMass * dotOf(row.linear, i, column.linear.row(k));
}
template <int rows, int columns>
[[gnu::always_inline]] inline void addTurn(const ConstraintBlock::Jacobian& angular,
                                           const ConstraintBlock::Jacobian& turn, double* __restrict__ entries,
                                           int stride) {
  for (int k = 0; k < columns; ++k)
    for (int i = 0; i < rows; ++i) entries[k * stride + i] += dotOf(angular, i, turn.row(k));
}

/// Puts entries of the Delassus operator W = J M^-1 J^T, column by column and `stride` apart: what the rows of a block
/// see of 1 of each multiplier of `column`, by the bodies that they share, one at least. A column may push in other
/// directions than it sees, as a sliding contact does.
template <int rows, int columns>
[[gnu::always_inline]] inline void putDelassus(const ConstraintBlock& row, const ConstraintBlock& column,
                                               const SharedBodies& shared, const BlockResponse& response,
                                               double* entries, int stride) {
  const double massA = response.inverseMassA, massB = response.inverseMassB;
  putMass<rows, columns>(
      row, column,
      (shared.aa ? massA : 0) + (shared.bb ? massB : 0) - (shared.ab ? massB : 0) - (shared.ba ? massA : 0), entries,
      stride);
  const auto add = [&](const ConstraintBlock::Jacobian& angular, const ConstraintBlock::Jacobian& turn) {
    addTurn<rows, columns>(angular, turn, entries, stride);
  };
  if (shared.aa && row.turnsA && column.turnsA) add(row.angularA, response.turnA);
  if (shared.bb && row.turnsB && column.turnsB) add(row.angularB, response.turnB);
  if (shared.ab && row.turnsA && column.turnsB) add(row.angularA, response.turnB);
  if (shared.ba && row.turnsB && column.turnsA) add(row.angularB, response.turnA);
}

/// The same of a block with itself.
template <int rows>
[[gnu::always_inline]] inline void putDelassus(const ConstraintBlock& block, const BlockResponse& response,
                                               double* entries) {
  putMass<rows, rows>(block, block, response.inverseMassA + response.inverseMassB, entries, rows);
  if (block.turnsA) addTurn<rows, rows>(block.angularA, response.turnA, entries, rows);
  if (block.turnsB) addTurn<rows, rows>(block.angularB, response.turnB, entries, rows);
}

/// What a multiplier of 1 adds to the rate of a block of one row: its entry of W.
double mobilityOf(const ConstraintBlock& row, const std::vector<RigidBody>& bodies,
                  const std::vector<BodyFrame>& frames);

/// J v of the rows of a block for the velocities, or accelerations, in `state`.
template <int rows>
[[gnu::always_inline]] inline void findRates(const ConstraintBlock& block, const VectorX& state,
                                             double* __restrict__ rates) {
  Vec3 relative = Vec3::Zero();
  if (block.bodyA != kFixed) relative += linearVelocity(state, block.bodyA);
  if (block.bodyB != kFixed) relative -= linearVelocity(state, block.bodyB);
  if (block.isPoint)
    for (int i = 0; i < rows; ++i) rates[i] = i < 3 ? relative[i] : 0;
  else
    for (int i = 0; i < rows; ++i) rates[i] = dotOf(block.linear, i, relative);
  const auto addSpin = [&](int body, const ConstraintBlock::Jacobian& angular) {
    const Vec3 spin = angularVelocity(state, body);
    for (int i = 0; i < rows; ++i) rates[i] += dotOf(angular, i, spin);
  };
  if (block.turnsA) addSpin(block.bodyA, block.angularA);
  if (block.turnsB) addSpin(block.bodyB, block.angularB);
}

/// Calls add(body, linear, angular) with what multipliers of the rows give to each body that is not fixed.
template <class Add>
[[gnu::always_inline]] inline void addResponse(const ConstraintBlock& block, const BlockResponse& response,
                                               const double* multipliers, const Add& add) {
  Vec3 force = Vec3::Zero(), turnA = Vec3::Zero(), turnB = Vec3::Zero();
  withRows(block.rows, [&](auto rows) {
    const auto sum = [&](const ConstraintBlock::Jacobian& jacobian, Vec3& total) {
      for (int i = 0; i < rows; ++i) total += multipliers[i] * jacobian.row(i).transpose();
    };
    if (block.isPoint)
      force = Vec3(multipliers[0], multipliers[1], multipliers[2]);
    else
      sum(block.linear, force);
    if (block.turnsA) sum(response.turnA, turnA);
    if (block.turnsB) sum(response.turnB, turnB);
  });
  if (block.bodyA != kFixed) add(block.bodyA, Vec3(response.inverseMassA * force), turnA);
  if (block.bodyB != kFixed) add(block.bodyB, Vec3(-response.inverseMassB * force), turnB);
}

/// Adds to the velocities, or accelerations, in `state` what multipliers of the rows give.
inline void addResponse(const ConstraintBlock& block, const BlockResponse& response, const double* multipliers,
                        VectorX& state) {
  addResponse(block, response, multipliers, [&state](int body, const Vec3& linear, const Vec3& angular) {
    linearVelocity(state, body) += linear;
    angularVelocity(state, body) += angular;
  });
}

}  // namespace cradle
