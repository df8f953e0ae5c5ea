#pragma once

#include <array>
#include <vector>

#include "constraints/constraint_block.h"

namespace cradle {

/// M^-1 J^T of a block: what multipliers of its rows give to its bodies.
struct BlockResponse {
  double inverseMassA = 0, inverseMassB = 0;  // 1/kg; 0 if fixed
  ConstraintBlock::Jacobian turnA, turnB;     // angularA I^-1, angularB I^-1; not set where these are zero
};
void findResponse(const ConstraintBlock& block, const std::vector<RigidBody>& bodies,
                  const std::vector<BodyFrame>& frames, BlockResponse& response);

/// A row times a vector. Loops over the rows become loops over neighbours in memory, two at a time.
template <class Vector>
[[gnu::always_inline]] inline double dotOf(const ConstraintBlock::Jacobian& jacobian, int row, const Vector& vector) {
  return jacobian(row, 0) * vector[0] + jacobian(row, 1) * vector[1] + jacobian(row, 2) * vector[2];
}

/// Puts entries of the Delassus operator W = J M^-1 J^T, column by column and `stride` apart: what the rows of a block
/// see of 1 of each multiplier of `column`, by the bodies that both have. A column may push in other directions than it
/// sees, as a sliding contact does.
template <int rows, int columns>
[[gnu::always_inline]] inline void putDelassus(const ConstraintBlock& row, const ConstraintBlock& column,
                                               const BlockResponse& response, double* entries, int stride) {
  std::array<double, static_cast<std::size_t>(rows * columns)> sums{};
  const auto add = [&](const auto& entryOf) {
    for (int k = 0; k < columns; ++k)
      for (int i = 0; i < rows; ++i) sums[static_cast<std::size_t>(k * rows + i)] += entryOf(i, k);
  };
  const auto addMass = [&](double inverseMass) {
    if (row.isPoint && column.isPoint)
      add([&](int i, int k) { return i == k && i < 3 ? inverseMass : 0; });
    else
      add([&](int i, int k) { return inverseMass * dotOf(row.linear, i, column.linear.row(k)); });
  };
  const auto addTurn = [&](const ConstraintBlock::Jacobian& angular, const ConstraintBlock::Jacobian& turn) {
    add([&](int i, int k) { return dotOf(angular, i, turn.row(k)); });
  };
  const auto isShared = [](int body, int other) { return body != kFixed && body == other; };
  const bool aa = isShared(row.bodyA, column.bodyA), bb = isShared(row.bodyB, column.bodyB);
  const bool ab = isShared(row.bodyA, column.bodyB), ba = isShared(row.bodyB, column.bodyA);
  if (aa || bb) addMass((aa ? response.inverseMassA : 0) + (bb ? response.inverseMassB : 0));
  if (ab || ba) addMass(-(ab ? response.inverseMassB : 0) - (ba ? response.inverseMassA : 0));
  if (aa && row.turnsA && column.turnsA) addTurn(row.angularA, response.turnA);
  if (bb && row.turnsB && column.turnsB) addTurn(row.angularB, response.turnB);
  if (ab && row.turnsA && column.turnsB) addTurn(row.angularA, response.turnB);
  if (ba && row.turnsB && column.turnsA) addTurn(row.angularB, response.turnA);
  for (int k = 0; k < columns; ++k)
    for (int i = 0; i < rows; ++i) entries[k * stride + i] = sums[static_cast<std::size_t>(k * rows + i)];
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
