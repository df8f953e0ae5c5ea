#pragma once

#include <optional>

#include "dynamics/polhode.h"
#include "math/jacobi_elliptic.h"
#include "math/theta_phase.h"
#include "math/types.h"

namespace cradle {

struct RotationState {
  Quat worldFromBody;    // unit
  Vec3 angularVelocity;  // rad/s, world
};

/// The rotation of a rigid body on which no torque acts, in closed form: any time costs the same, and the error does
/// not grow but by the rounding of the angle turned. Inertia tensor in the body's frame, positive definite; `start`, at
/// time 0, finite.
class FreeRotation {
 public:
  FreeRotation(const Mat3& inertiaTensor, const RotationState& start);

  /// Time in s, finite. O(1).
  RotationState at(double time) const;

 private:
  /// Rotation whose axis moves in the body.
  class Wobble {
   public:
    Wobble(const Polhode& polhode, const Quat& worldFromBody);
    RotationState at(double time) const;

   private:
    Vec3 momentumDirection(double phase) const;
    Quat momentumFromAxes(const Vec3& direction, double time) const;

    Polhode polhode_;
    JacobiElliptic elliptic_;
    ThetaPhase theta_;
    double phaseAtStart_;     // rad, pi/2 for each quarter period of the elliptic functions
    double phaseRate_;        // rad/s
    double precessionRate_;   // rad/s, half of the mean precession about the angular momentum
    Quat worldFromMomentum_;  // of a frame whose z axis is the angular momentum
  };

  RotationState start_;
  std::optional<Wobble> wobble_;
};

}  // namespace cradle
