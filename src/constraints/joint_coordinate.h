#pragma once

#include "constraints/constraint_block.h"

namespace cradle {

/// How far A has moved along the axis of a slider (m), or turned about that of a hinge (rad), against B since the
/// start. As a constraint it keeps that coordinate q at `value`: C = q - value, of a turn the least of all that differ
/// by whole turns. It stands beside the joint's own rows and relies on them: the multiplier is a force (N) along the
/// axis on A in its anchor, or a torque (N m).
struct JointCoordinate {
  static constexpr int kRows = 1;
  bool turns = false;                                     // about the axis, else along it
  Vec3 axisB = Vec3::UnitZ();                             // unit; in body B's frame, or the world
  Vec3 acrossA = Vec3::UnitX(), acrossB = Vec3::UnitX();  // of a turn: unit, across the axis, one direction at q = 0;
                                                          // in body A's and in body B's frame, or the world
  double value = 0;                                       // m or rad
  double compliance = 0;                                  // of a ConstraintBlock
};

/// Of the angles that differ from one by whole turns (rad) that which is nearest to `near`.
double nearestTurn(double angle, double near);

void putRows(const JointCoordinate& joint, const ConstraintEnds& ends, ConstraintBlock& block);

}  // namespace cradle
