#pragma once

#include <array>
#include <type_traits>

#include "core/error.h"
#include "dynamics/rigid_body.h"

namespace cradle {

/// Of the lengths that enter a row: a few units in their last place.
constexpr double kRowRounding = 1e-15;

/// The rows of one constraint C(positions) = 0 of two bodies, or of a contact of them, at one instant, one to six. It
/// depends on where A is relative to B, so that dC/dt = linear (v_A - v_B) + angularA w_A + angularB w_B: the Jacobian
/// J in parts, in the world's frame. d^2C/dt^2 = J a + (dJ/dt) v is 0 for J a = -velocityProduct. (R. Featherstone,
/// "Rigid Body Dynamics Algorithms", 2008, 3.4)
struct ConstraintBlock {
  static constexpr int kMaxRows = 6;
  using Jacobian = Eigen::Matrix<double, kMaxRows, 3>;
  using Values = std::array<double, kMaxRows>;

  int bodyA = kFixed, bodyB = kFixed;
  int rows = 0;
  Jacobian linear, angularA, angularB;
  bool isPoint = false;                 // `linear` is the identity, and zero from the fourth row on
  bool turnsA = false, turnsB = false;  // else angularA, angularB are zero, and not set
  Values value{};                       // C, the constraint error
  Values velocityProduct{};             // (dJ/dt) v
  Values rounding{};                    // m, or rad: an error that arithmetic alone explains
  double scale = 1;                     // C / scale is the error in m, or rad
  double compliance = 0;                // velocity (or acceleration) with which each row gives way to a multiplier of 1
};

/// A body of a constraint at one instant, and the constraint's point on it; world frame.
struct ConstraintEnd {
  Vec3 position, arm;              // m: of the point, and from the centre of mass to it; zero if fixed
  Vec3 velocity, angularVelocity;  // m/s, of the centre of mass; rad/s; zero if fixed
  const Mat3* rotation = nullptr;  // worldFromBody; null if fixed

  Vec3 pointVelocity() const { return velocity + angularVelocity.cross(arm); }
  Vec3 centripetalAcceleration() const { return angularVelocity.cross(angularVelocity.cross(arm)); }  // m/s^2
  Vec3 turned(const Vec3& direction) const { return rotation ? Vec3(*rotation * direction) : direction; }
};

struct ConstraintEnds {
  ConstraintEnd a, b;
  Vec3 centripetalAcceleration() const { return a.centripetalAcceleration() - b.centripetalAcceleration(); }
};

/// Calls visit(std::integral_constant of `rows`): loops over the rows of a constraint have a length that the compiler
/// knows.
template <class Visit>
[[gnu::always_inline]] inline void withRows(int rows, const Visit& visit) {
  if (rows == 1) return visit(std::integral_constant<int, 1>());
  if (rows == 3) return visit(std::integral_constant<int, 3>());
  if (rows == 5) return visit(std::integral_constant<int, 5>());
  CRADLE_CHECK(rows == 6);
  visit(std::integral_constant<int, 6>());
}

/// J v of one of the rows for the velocities, or accelerations, in `state`.
double rateOf(const ConstraintBlock& block, int row, const VectorX& state);

}  // namespace cradle
