#pragma once

#include <array>

#include "constraints/constraint_row.h"
#include "math/rotation.h"

// A constraint's two ends on bodies that move, for tests of its rows.

namespace cradle {

/// A body at a constant velocity that turns at a constant rate, and a point of it.
struct MovingEnd {
  Vec3 center, velocity, angularVelocity;  // m, m/s, rad/s at time 0
  Quat start;                              // orientation at time 0
  Vec3 point;                              // m, from the centre of mass in the body's frame

  Mat3 rotationIn(double time) const {
    const double angle = time * angularVelocity.norm();
    return (rotationAbout(angularVelocity, angle) * start).toRotationMatrix();
  }
  /// `rotation` has to live as long as the result.
  ConstraintEnd in(double time, Mat3& rotation) const {
    rotation = rotationIn(time);
    const Vec3 arm = rotation * point;
    return {center + time * velocity + arm, arm, velocity, angularVelocity, &rotation};
  }
};

/// Two of them without any symmetry.
inline std::array<MovingEnd, 2> someMovingEnds() {
  return {{{Vec3(1, 2, 3), Vec3(0.4, -1, 0.3), Vec3(1.2, -0.7, 0.5), rotationAbout(Vec3(1, 2, 3), 0.9),
            Vec3(0.3, -0.2, 0.1)},
           {Vec3(-1, 0.5, 2), Vec3(-0.2, 0.7, 1), Vec3(0.3, 1.1, -0.8), rotationAbout(Vec3(-2, 1, 0.5), 2.1),
            Vec3(0.1, 0.4, -0.2)}}};
}

/// An end that is fixed to the world.
inline ConstraintEnd fixedEnd(const Vec3& point) {
  return {point, Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), nullptr};
}

/// The rows of a constraint of `kind` between two ends.
template <class Kind>
ConstraintBlock blockOf(const Kind& kind, const ConstraintEnds& ends) {
  ConstraintBlock block;
  block.rows = Kind::kRows;
  block.turnsA = ends.a.rotation && ends.a.arm != Vec3::Zero();
  block.turnsB = ends.b.rotation && ends.b.arm != Vec3::Zero();
  block.bodyA = 0, block.bodyB = ends.b.rotation ? 1 : kFixed;
  putRows(kind, ends, block);
  return block;
}

/// A row at a time, of both ends moving, or of the first one and a point of the world.
template <class Kind>
ConstraintRow rowIn(double time, const Kind& kind, int row, bool isBFixed = false) {
  const auto [a, b] = someMovingEnds();
  Mat3 rotationA, rotationB;
  const ConstraintEnd endB = isBFixed ? fixedEnd(Vec3(0.2, 1, -0.4)) : b.in(time, rotationB);
  return rowOf(blockOf(kind, {a.in(time, rotationA), endB}), row);
}

/// J v of a row for the velocities of the ends.
inline double rateOf(const ConstraintRow& row, bool isBFixed) {
  const auto [a, b] = someMovingEnds();
  double rate = row.linearA.dot(a.velocity) + row.angularA.dot(a.angularVelocity);
  if (!isBFixed) rate += row.linearB.dot(b.velocity) + row.angularB.dot(b.angularVelocity);
  return rate;
}

// Of a derivative by five points h = 1e-3 apart: h^4 / 30 times the fifth derivative, of a few hundred (metres times
// the fifth power of 1 to 2 rad/s), and 1.5 / h times the rounding 1e-15 of values below 10.
inline constexpr double kDerivativeError = 1e-10;

/// d/dt at time 0.
template <class Function>
double timeDerivative(const Function& function) {
  constexpr double kStep = 1e-3;
  return (8 * (function(kStep) - function(-kStep)) - function(2 * kStep) + function(-2 * kStep)) / (12 * kStep);
}

/// dC/dt = J v and, at constant velocities, d^2C/dt^2 = (dJ/dt) v for all rows: largest error of either.
template <class Kind>
double largestDerivativeError(const Kind& kind) {
  double largest = 0;
  for (const bool isBFixed : {false, true})
    for (int row = 0; row < Kind::kRows; ++row) {
      const auto rowAt = [&](double time) { return rowIn(time, kind, row, isBFixed); };
      const ConstraintRow now = rowAt(0);
      const double rate = timeDerivative([&](double time) { return rowAt(time).value; });
      const double second = timeDerivative([&](double time) { return rateOf(rowAt(time), isBFixed); });
      largest = std::max({largest, std::abs(rateOf(now, isBFixed) - rate), std::abs(now.velocityProduct - second)});
    }
  return largest;
}

}  // namespace cradle
